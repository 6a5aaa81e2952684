//! Writer of the container of `.bsdf` files.

/// A named array of numbers.
pub struct Field {
    pub name: String,
    /// Its dimensions.
    pub shape: Vec<usize>,
    /// Type of its numbers, 1 for bytes and 10 for f32.
    pub kind: u8,
    pub bytes: Vec<u8>,
}

/// A container, as [`tensor`](super::tensor) reads it.
#[derive(Default)]
pub struct Fields(pub Vec<Field>);

impl Fields {
    /// Adds an array of 32-bit numbers.
    pub fn push(&mut self, name: &str, shape: &[usize], values: &[f64]) {
        self.push_each(name, shape, values.iter().copied());
    }

    /// The same of numbers that are nowhere together.
    pub fn push_each(&mut self, name: &str, shape: &[usize], values: impl Iterator<Item = f64>) {
        let count = shape.iter().product::<usize>();
        let mut bytes = Vec::with_capacity(4 * count);
        values.for_each(|v| bytes.extend((v as f32).to_le_bytes()));
        assert_eq!(bytes.len(), 4 * count, "{name}");
        self.0.push(Field { name: name.to_owned(), shape: shape.to_vec(), kind: 10, bytes });
    }

    /// Adds an array of bytes.
    pub fn push_bytes(&mut self, name: &str, bytes: &[u8]) {
        self.0.push(Field {
            name: name.to_owned(),
            shape: vec![bytes.len()],
            kind: 1,
            bytes: bytes.to_vec(),
        });
    }

    /// The bytes of the file.
    pub fn encode(&self) -> Vec<u8> {
        let mut head = b"tensor_file\0\x01\0".to_vec();
        head.extend((self.0.len() as u32).to_le_bytes());
        let length: usize = self.0.iter().map(|f| 2 + f.name.len() + 2 + 1 + 8 + 8 * f.shape.len()).sum();
        let mut before = 0;
        for Field { name, shape, kind, bytes } in &self.0 {
            head.extend((name.len() as u16).to_le_bytes());
            head.extend(name.as_bytes());
            head.extend((shape.len() as u16).to_le_bytes());
            head.push(*kind);
            head.extend(((18 + length + before) as u64).to_le_bytes());
            shape.iter().for_each(|n| head.extend((*n as u64).to_le_bytes()));
            before += bytes.len();
        }
        self.0.iter().for_each(|field| head.extend(&field.bytes));
        head
    }
}
