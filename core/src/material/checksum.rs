//! CRC-32 (IEEE 802.3, reflected), 32 bits at a time by tables of 16 numbers: half a kB suits small targets.

const POLYNOMIAL: u32 = 0xedb8_8320;

/// What four bits become that stand in front of 28 to 0 others.
const TABLES: [[u32; 16]; 8] = {
    let mut tables = [[0u32; 16]; 8];
    let mut i = 0;
    while i < 8 * 16 {
        let (mut crc, mut bit) = ((i % 16) as u32, 0);
        while bit < 4 * (i / 16 + 1) {
            crc = if crc & 1 == 1 { POLYNOMIAL ^ (crc >> 1) } else { crc >> 1 };
            bit += 1;
        }
        tables[i / 16][i % 16] = crc;
        i += 1;
    }
    tables
};

/// Computes the CRC-32 of the bytes; finds every error of up to 32 adjacent bits.
pub(crate) fn crc32(bytes: &[u8]) -> u32 {
    let (words, rest) = bytes.as_chunks::<4>();
    let by_four = |crc: u32| TABLES[0][(crc & 15) as usize] ^ (crc >> 4);
    let crc = words.iter().fold(!0, |crc, word| {
        let crc = crc ^ u32::from_le_bytes(*word);
        // Each reads on its own: only their sum waits for the word before.
        (0..8).fold(0, |sum, n| sum ^ TABLES[7 - n][(crc >> (4 * n) & 15) as usize])
    });
    !rest.iter().fold(crc, |crc, byte| by_four(by_four(crc ^ u32::from(*byte))))
}

#[cfg(test)]
mod tests {
    #[test]
    fn known_values() {
        assert_eq!(super::crc32(b"123456789"), 0xcbf4_3926);
        assert_eq!(super::crc32(b""), 0);
        assert_eq!(super::crc32(b"a"), 0xe8b7_be43);
        assert_eq!(super::crc32(b"The quick brown fox jumps over the lazy dog"), 0x414f_a339);
    }
}
