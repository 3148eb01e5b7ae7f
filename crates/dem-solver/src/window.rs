//! Entries of a range of bodies, by the numbers of the bodies.

#![expect(
    clippy::inline_always,
    reason = "the hot loops are vectorised only when inlined"
)]

use std::ops::Index;

/// One entry for each of the bodies from `first` on.
#[derive(Debug)]
pub(crate) struct Window<'a, T> {
    first: usize,
    all: &'a [T],
}

impl<'a, T> Window<'a, T> {
    /// Entries of the bodies from `first` on.
    pub(crate) fn new(first: usize, all: &'a [T]) -> Self {
        Self { first, all }
    }

    /// Entries of all bodies.
    pub(crate) fn whole(all: &'a [T]) -> Self {
        Self::new(0, all)
    }

    /// Whether there are none.
    pub(crate) fn is_empty(&self) -> bool {
        self.all.is_empty()
    }
}

impl<T> Clone for Window<'_, T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for Window<'_, T> {}

impl<T> Index<usize> for Window<'_, T> {
    type Output = T;

    #[inline(always)]
    fn index(&self, body: usize) -> &T {
        &self.all[body - self.first]
    }
}
