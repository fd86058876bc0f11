//! Numerical helpers: Gauss–Legendre rules and sin(πx)/(πx).

pub(crate) mod quadrature;
pub(crate) mod sinc;
