//! What stands in one cell of a table.

/// What a cell holds.
pub(super) enum Cell {
    /// A finite number.
    Number(f64),
    /// Nothing, or what is not finite.
    Missing,
    /// Neither.
    Text,
}

/// Reads a cell; a decimal comma, where commas do not separate cells, is noted.
pub(super) fn number(cell: &[u8], delimiter: u8, decimal_commas: &mut bool) -> Cell {
    let cell = cell.trim_ascii();
    if cell.is_empty() {
        return Cell::Missing;
    }
    let Ok(text) = std::str::from_utf8(cell) else {
        return Cell::Text;
    };
    let parsed = text.parse::<f64>().ok().or_else(|| {
        let european = delimiter != b',' && !text.contains('.') && text.matches(',').count() == 1;
        let value = european
            .then(|| text.replace(',', ".").parse().ok())
            .flatten();
        *decimal_commas |= value.is_some();
        value
    });
    match parsed {
        Some(value) if value.is_finite() => Cell::Number(value),
        Some(_) => Cell::Missing,
        None => Cell::Text,
    }
}
