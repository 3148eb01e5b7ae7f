//! Which members of a set have been joined.

/// Members joined to parts, by the rule of Tarjan: a forest in which each tree is a part.
#[derive(Debug, Clone)]
pub(crate) struct Pieces {
    /// The next member on the way to the root; a root names itself.
    above: Vec<usize>,
    /// Members of the tree below a root.
    size: Vec<usize>,
    /// Number of parts.
    count: usize,
}

impl Pieces {
    /// Every member a part of its own.
    pub(crate) fn new(count: usize) -> Self {
        Self {
            above: (0..count).collect(),
            size: vec![1; count],
            count,
        }
    }

    /// The member that represents the part of a member.
    pub(crate) fn root(&self, mut member: usize) -> usize {
        while self.above[member] != member {
            member = self.above[member];
        }
        member
    }

    /// Joins the parts of two members; false where they were one already.
    pub(crate) fn join(&mut self, pair: [usize; 2]) -> bool {
        let [mut a, mut b] = pair.map(|member| self.root(member));
        if a == b {
            return false;
        }
        // The smaller below the larger: no way is longer than the logarithm of the number.
        if self.size[a] < self.size[b] {
            (a, b) = (b, a);
        }
        self.above[b] = a;
        self.size[a] += self.size[b];
        self.count -= 1;
        true
    }

    /// Number of parts.
    pub(crate) fn count(&self) -> usize {
        self.count
    }

    /// Members of the largest part.
    pub(crate) fn largest(&self) -> usize {
        self.size.iter().copied().max().unwrap_or(0)
    }
}
