//! Numerical methods that know nothing of the harvester.

pub mod chebyshev;
pub mod elementary;
pub mod product;
pub mod quadrature;
pub mod roots;
pub mod series;
