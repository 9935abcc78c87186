//! Numbers that tell lists of numbers apart.

/// FNV-1a over words, with a rotation that brings high bits down; never 0. `is_other`: of which of two kinds the list is.
pub fn fingerprint<'a>(is_other: bool, numbers: impl Iterator<Item = &'a f64>) -> u64 {
    const PRIME: u64 = 0x0100_0000_01b3;
    let first = 0xcbf2_9ce4_8422_2325 ^ u64::from(is_other);
    let mix = |hash: u64, number: &f64| ((hash ^ number.to_bits()).wrapping_mul(PRIME)).rotate_left(29);
    numbers.fold(first, mix).max(1)
}
