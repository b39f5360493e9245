//! Which functions of an image a function can reach, read off its branches.

use crate::cpu::{Op, decode};
use crate::elf::Image;
use std::collections::BTreeMap;

/// The functions that `from` reaches by calls and jumps, each with one that calls it; `None` if the image has no
/// function of that name. Calls through pointers are not followed.
pub fn reached(image: &Image, from: &str) -> Option<BTreeMap<String, String>> {
    let start = image.functions.iter().find(|f| f.name == from)?;
    let mut callers = BTreeMap::new();
    let mut waiting = vec![start];
    while let Some(function) = waiting.pop() {
        for target in targets(image, function.at, function.bytes) {
            let called = image.functions.iter().find(|f| f.at == target);
            if let Some(called) = called.filter(|f| f.name != from)
                && !callers.contains_key(&called.name)
            {
                callers.insert(called.name.clone(), function.name.clone());
                waiting.push(called);
            }
        }
    }
    Some(callers)
}

/// Where the branches between two addresses lead. Constants among the code read as instructions, too; one that
/// leads to the first byte of a function by chance has not been seen.
fn targets(image: &Image, at: u32, bytes: u32) -> Vec<u32> {
    let (mut targets, mut next) = (Vec::new(), at);
    while next < at + bytes {
        for (place, instruction) in decode::decode(next, |at| image.half(at)) {
            if let Op::BranchLink { target } | Op::Branch { target } = instruction.op {
                targets.push(target & !1);
            }
            next = place + u32::from(instruction.length);
        }
    }
    targets
}
