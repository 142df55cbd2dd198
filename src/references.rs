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
//!
//! # Haines2019
//! E. Haines, J. Günther, T. Akenine-Möller: Precision Improvements for Ray/Sphere Intersection. Ray Tracing Gems, chapter 7,
//! Apress, 2019. <https://doi.org/10.1007/978-1-4842-4427-2_7>
//!
//! # Higham2002
//! N. J. Higham: Accuracy and Stability of Numerical Algorithms, second edition. SIAM, 2002.
//! <https://doi.org/10.1137/1.9780898718027>
//!
//! # Ize2013
//! T. Ize: Robust BVH Ray Traversal. Journal of Computer Graphics Techniques 2(2), 2013.
//! <https://jcgt.org/published/0002/02/02/>
//!
//! # Neumaier1974
//! A. Neumaier: Rundungsfehleranalyse einiger Verfahren zur Summation endlicher Summen. Zeitschrift für Angewandte Mathematik
//! und Mechanik 54(1), 1974. <https://doi.org/10.1002/zamm.19740540106>
//!
//! # Wald2007
//! I. Wald: On fast Construction of SAH-based Bounding Volume Hierarchies. IEEE Symposium on Interactive Ray Tracing, 2007.
//! <https://doi.org/10.1109/RT.2007.4342588>
//!
//! # Woop2013
//! S. Woop, C. Benthin, I. Wald: Watertight Ray/Triangle Intersection. Journal of Computer Graphics Techniques 2(1), 2013.
//! <https://jcgt.org/published/0002/01/05/>
