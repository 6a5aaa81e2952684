//! Sizes of tables of factors.

/// The size of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Size {
    /// Nodes over half angle, difference angle and azimuth.
    pub nodes: [usize; 3],
    /// Whether those over the azimuth are from -1 to 1, in the squared cosine with the sign of the cosine, not from 0 to 1.
    pub is_signed: bool,
}

impl Size {
    /// A table that is the same for two directions that change places.
    pub const fn reciprocal(nodes: [usize; 3]) -> Self {
        Self { nodes, is_signed: false }
    }

    /// A table that knows which direction is the higher one.
    pub const fn signed(nodes: [usize; 3]) -> Self {
        Self { nodes, is_signed: true }
    }

    /// Bytes of the table in a material of some views: the head of the block, that of the table, the largest factor, and the albedo
    /// differences; then the nodes.
    pub const fn bytes(self, views: usize) -> usize {
        (8 + 4 + 4 + 12 * views + 3 * self.count()).next_multiple_of(4)
    }

    /// The number of nodes.
    pub const fn count(self) -> usize {
        self.nodes[0] * self.nodes[1] * self.nodes[2]
    }
}

/// The size that is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Asked {
    /// This one.
    Given(Size),
    /// The one that is worth its bytes, in a material of at most this number.
    Within(usize),
}
