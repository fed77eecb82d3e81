//! The word that a client beyond this machine has to bring.

use rand::Rng;

/// A new one: 128 bits from the system's source.
pub fn new() -> String {
    let number: u128 = rand::rng().random();
    format!("{number:032x}")
}

/// Whether both are the same, in a time that says nothing of where they differ.
pub fn same(one: &str, other: &str) -> bool {
    if one.len() != other.len() {
        return false;
    }
    let pairs = std::iter::zip(one.bytes(), other.bytes());
    let differences = pairs.fold(0, |sum: u8, (a, b)| std::hint::black_box(sum | (a ^ b)));
    std::hint::black_box(differences) == 0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_same_is_the_same() {
        let token = new();
        assert_eq!(token.len(), 32);
        assert_ne!(token, new());
        assert!(same(&token, &token.clone()));
        assert!(!same(&token, &token[..31]) && !same(&token, ""));
        let last = if token.ends_with('0') { "1" } else { "0" };
        assert!(!same(&token, &format!("{}{last}", &token[..31])));
    }
}
