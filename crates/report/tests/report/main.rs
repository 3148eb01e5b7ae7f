//! What charts and pages must be, checked through the public interface.

#[cfg(test)]
mod charts;
#[cfg(test)]
mod examples;
#[cfg(test)]
mod markup;
#[cfg(test)]
mod page;
