//! Text and numbers, without the machinery of formatting.

/// Writes text.
pub fn text(text: &str) {
    #[cfg(target_os = "none")]
    crate::machine::write(text.as_bytes());
    #[cfg(not(target_os = "none"))]
    print!("{text}");
}

/// Ends a line.
pub fn line() {
    text("\n");
}

/// Writes digits of a number, from the highest, of a base up to 16.
fn digits(mut number: u32, base: u32, least: usize) {
    let mut bytes = [b'0'; 10];
    let mut from = bytes.len();
    for (i, byte) in bytes.iter_mut().enumerate().rev() {
        if number == 0 && 10 - i > least {
            break;
        }
        let digit = (number % base) as u8;
        *byte = if digit < 10 { b'0' + digit } else { b'a' - 10 + digit };
        number /= base;
        from = i;
    }
    text(core::str::from_utf8(bytes.get(from..).unwrap_or_default()).unwrap_or_default());
}

/// Writes a number of eight hexadecimal digits.
pub fn hexadecimal(number: u32) {
    digits(number, 16, 8);
}

/// Writes a decimal number.
#[cfg(target_os = "none")]
pub fn decimal(number: u32) {
    digits(number, 10, 1);
}
