//! The papers, books and standards that the code cites, one heading each. Documentation only.
//!
//! # Duff2017
//! T. Duff, J. Burgess, P. Christensen, C. Hery, A. Kensler, M. Liani, R. Villemin: Building an Orthonormal Basis, Revisited.
//! Journal of Computer Graphics Techniques 6(1), 2017. <https://jcgt.org/published/0006/01/01/>
//!
//! # Heitz2019
//! E. Heitz: A Low-Distortion Map Between Triangle and Square. 2019. <https://hal.science/hal-02073696>
//!
//! # Shirley1997
//! P. Shirley, K. Chiu: A Low Distortion Map Between Disk and Square. Journal of Graphics Tools 2(3), 1997.
//! <https://doi.org/10.1080/10867651.1997.10487479>
//!
//! # FNV
//! G. Fowler, L. C. Noll, K.-P. Vo: FNV hash. <http://www.isthe.com/chongo/tech/comp/fnv/>
//!
//! # PNG3
//! W3C: Portable Network Graphics (PNG) Specification (Third Edition), 2025. <https://www.w3.org/TR/png-3/>
