//! A channel that keeps its value for many samples: each value once.

/// A value per sample, kept where it changes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Steps {
    /// Where each value begins.
    values: Vec<(u32, f32)>,
    count: u32,
}

impl Steps {
    pub(crate) fn push(&mut self, value: f32) {
        let last = self.values.last();
        if last.is_none_or(|(_, last)| last.to_bits() != value.to_bits()) {
            self.values.push((self.count, value));
        }
        self.count += 1;
    }

    /// The value at a sample: of the last one beyond it, and 0 of none.
    pub fn at(&self, sample: usize) -> f32 {
        let next = self
            .values
            .partition_point(|(from, _)| *from as usize <= sample);
        let own = next.checked_sub(1).and_then(|own| self.values.get(own));
        own.map_or(0.0, |(_, value)| *value)
    }

    /// The last value; 0 of none.
    pub fn last(&self) -> f32 {
        self.values.last().map_or(0.0, |(_, value)| *value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_sample_has_the_value_that_it_was_given() {
        let given = [0.0, 0.0, 3.5, 3.5, 3.5, -0.0, 0.0, 7.0];
        let mut steps = Steps::default();
        given.iter().for_each(|value| steps.push(*value));
        for (sample, value) in given.iter().enumerate() {
            assert_eq!(steps.at(sample).to_bits(), f32::to_bits(*value));
        }
        assert_eq!(steps.last(), 7.0);
        assert_eq!(Steps::default().last(), 0.0);
    }
}
