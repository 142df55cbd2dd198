//! The papers, books and standards that the code cites, one heading each. Documentation only.
//!
//! # Andersson2020
//! P. Andersson, J. Nilsson, T. Akenine-Möller, M. Oskarsson, K. Åström, M. D. Fairchild: FLIP: A Difference Evaluator for
//! Alternating Images. Proceedings of the ACM on Computer Graphics and Interactive Techniques 3(2), 2020.
//! <https://doi.org/10.1145/3406183>
//!
//! # AvcFile
//! ISO/IEC 14496-15: Information technology, Coding of audio-visual objects, Part 15: Carriage of network abstraction layer
//! (NAL) unit structured video in the ISO base media file format.
//!
//! # BaumRushmeier1989
//! D. Baum, H. Rushmeier, J. Winget: Improving Radiosity Solutions Through the Use of Analytically Determined Form-Factors.
//! SIGGRAPH 1989. <https://doi.org/10.1145/74334.74367>
//!
//! # Bayer1973
//! B. E. Bayer: An Optimum Method for Two-Level Rendition of Continuous-Tone Pictures. IEEE International Conference on
//! Communications, 1973.
//!
//! # Bekaert1999
//! P. Bekaert: Hierarchical and Stochastic Algorithms for Radiosity. PhD thesis, Katholieke Universiteit Leuven, 1999.
//!
//! # Benthin2024
//! C. Benthin, D. Meister, J. Barczak, R. Mehalwal, J. Tsakok, A. Kensler: H-PLOC: Hierarchical Parallel Locally-Ordered
//! Clustering for Bounding Volume Hierarchy Construction. Proceedings of the ACM on Computer Graphics and Interactive
//! Techniques 7(3), 2024.
//!
//! # BirdRiordan1986
//! R. Bird, C. Riordan: Simple Solar Spectral Model for Direct and Diffuse Irradiance on Horizontal and Tilted Planes at the
//! Earth's Surface for Cloudless Atmospheres. Journal of Climate and Applied Meteorology 25, 1986; also report SERI/TR-215-2436.
//! <https://doi.org/10.2172/5986936>
//!
//! # BornWolf1999
//! M. Born, E. Wolf: Principles of Optics. 7th edition. Cambridge University Press, 1999.
//!
//! # BT709
//! Recommendation ITU-R BT.709-6: Parameter values for the HDTV standards for production and international programme
//! exchange, 2015. <https://www.itu.int/rec/R-REC-BT.709>
//!
//! # Burley2012
//! B. Burley: Physically-Based Shading at Disney. SIGGRAPH 2012 course notes.
//! <https://disneyanimation.com/publications/physically-based-shading-at-disney/>
//!
//! # Burley2020
//! B. Burley: Practical Hash-based Owen Scrambling. Journal of Computer Graphics Techniques 9(4), 2020.
//! <https://jcgt.org/published/0009/04/01/>
//!
//! # Celarek2019
//! A. Celarek, W. Jakob, M. Wimmer, J. Lehtinen: Quantifying the Error of Light Transport Algorithms. Computer Graphics Forum
//! 38(4) (EGSR), 2019. <https://doi.org/10.1111/cgf.13775>
//!
//! # Chan1983
//! T. Chan, G. Golub, R. LeVeque: Algorithms for Computing the Sample Variance: Analysis and Recommendations. The American
//! Statistician 37(3), 1983. <https://doi.org/10.1080/00031305.1983.10483115>
//!
//! # Christensen1999
//! P. H. Christensen: Faster Photon Map Global Illumination. Journal of Graphics Tools 4(3), 1999.
//! <https://doi.org/10.1080/10867651.1999.10487505>
//!
//! # Cigolle2014
//! Z. Cigolle, S. Donow, D. Evangelakos, M. Mara, M. McGuire, Q. Meyer: A Survey of Efficient Representations for
//! Independent Unit Vectors. Journal of Computer Graphics Techniques 3(2), 2014. <https://jcgt.org/published/0003/02/01/>
//!
//! # CohenChen1988
//! M. Cohen, S. Chen, J. Wallace, D. Greenberg: A Progressive Refinement Approach to Fast Radiosity Image Generation.
//! SIGGRAPH 1988. <https://doi.org/10.1145/54852.378487>
//!
//! # CohenGreenberg1985
//! M. Cohen, D. Greenberg: The Hemi-Cube: A Radiosity Solution for Complex Environments. SIGGRAPH 1985.
//! <https://doi.org/10.1145/325165.325171>
//!
//! # CohenGreenberg1986
//! M. Cohen, D. Greenberg, D. Immel, P. Brock: An Efficient Radiosity Approach for Realistic Image Synthesis. IEEE Computer
//! Graphics and Applications 6(3), 1986. <https://doi.org/10.1109/MCG.1986.276629>
//!
//! # CohenWallace1993
//! M. Cohen, J. Wallace: Radiosity and Realistic Image Synthesis. Academic Press, 1993.
//!
//! # ContyKulla2018
//! A. Conty Estevez, C. Kulla: Importance Sampling of Many Lights with Adaptive Tree Splitting. Proceedings of the ACM on
//! Computer Graphics and Interactive Techniques 1(2), 2018. <https://doi.org/10.1145/3233305>
//!
//! # Cook1984
//! R. Cook, T. Porter, L. Carpenter: Distributed Ray Tracing. SIGGRAPH, 1984. <https://doi.org/10.1145/800031.808590>
//!
//! # Dekker1971
//! T. J. Dekker: A Floating-Point Technique for Extending the Available Precision. Numerische Mathematik 18, 1971.
//! <https://doi.org/10.1007/BF01397083>
//!
//! # Duff2017
//! T. Duff, J. Burgess, P. Christensen, C. Hery, A. Kensler, M. Liani, R. Villemin: Building an Orthonormal Basis, Revisited.
//! Journal of Computer Graphics Techniques 6(1), 2017. <https://jcgt.org/published/0006/01/01/>
//!
//! # DupuyBenyoub2023
//! J. Dupuy, A. Benyoub: Sampling Visible GGX Normals with Spherical Caps. Computer Graphics Forum 42(8), 2023.
//! <https://doi.org/10.1111/cgf.14867>
//!
//! # Ernst2006
//! M. Ernst, M. Stamminger, G. Greiner: Filter Importance Sampling. IEEE Symposium on Interactive Ray Tracing, 2006.
//! <https://doi.org/10.1109/RT.2006.280223>
//!
//! # FNV
//! G. Fowler, L. C. Noll, K.-P. Vo: FNV hash. <http://www.isthe.com/chongo/tech/comp/fnv/>
//!
//! # H264
//! Recommendation ITU-T H.264: Advanced video coding for generic audiovisual services. <https://www.itu.int/rec/T-REC-H.264>
//!
//! # Hachisuka2008
//! T. Hachisuka, S. Ogaki, H. W. Jensen: Progressive Photon Mapping. ACM Transactions on Graphics 27(5), 2008.
//! <https://doi.org/10.1145/1409060.1409083>
//!
//! # Haines2019
//! E. Haines, J. Günther, T. Akenine-Möller: Precision Improvements for Ray/Sphere Intersection. Ray Tracing Gems, chapter 7,
//! Apress, 2019. <https://doi.org/10.1007/978-1-4842-4427-2_7>
//!
//! # HallGreenberg1983
//! R. Hall, D. Greenberg: A Testbed for Realistic Image Synthesis. IEEE Computer Graphics and Applications 3(8), 1983.
//! <https://doi.org/10.1109/MCG.1983.263292>
//!
//! # Harris1978
//! F. Harris: On the Use of Windows for Harmonic Analysis with the Discrete Fourier Transform. Proceedings of the IEEE
//! 66(1), 1978. <https://doi.org/10.1109/PROC.1978.10837>
//!
//! # Heitz2014
//! E. Heitz: Understanding the Masking-Shadowing Function in Microfacet-Based BRDFs. Journal of Computer Graphics
//! Techniques 3(2), 2014. <https://jcgt.org/published/0003/02/03/>
//!
//! # Heitz2018
//! E. Heitz: Sampling the GGX Distribution of Visible Normals. Journal of Computer Graphics Techniques 7(4), 2018.
//! <https://jcgt.org/published/0007/04/01/>
//!
//! # Heitz2019
//! E. Heitz: A Low-Distortion Map Between Triangle and Square. 2019. <https://hal.science/hal-02073696>
//!
//! # HeyPurgathofer2002
//! H. Hey, W. Purgathofer: Advanced Radiance Estimation for Photon Map Global Illumination. Computer Graphics Forum 21(3), 2002.
//! <https://doi.org/10.1111/1467-8659.00695>
//!
//! # Higham2002
//! N. J. Higham: Accuracy and Stability of Numerical Algorithms, second edition. SIAM, 2002.
//! <https://doi.org/10.1137/1.9780898718027>
//!
//! # HosekWilkie2012
//! L. Hosek, A. Wilkie: An Analytic Model for Full Spectral Sky-Dome Radiance. ACM Transactions on Graphics 31(4), 2012.
//! <https://doi.org/10.1145/2185520.2185591>
//!
//! # Hart1968
//! P. E. Hart, N. J. Nilsson, B. Raphael: A Formal Basis for the Heuristic Determination of Minimum Cost Paths. IEEE Transactions
//! on Systems Science and Cybernetics 4(2), 1968. <https://doi.org/10.1109/TSSC.1968.300136>
//!
//! # Isobmff
//! ISO/IEC 14496-12: Information technology, Coding of audio-visual objects, Part 12: ISO base media file format.
//!
//! # Ize2013
//! T. Ize: Robust BVH Ray Traversal. Journal of Computer Graphics Techniques 2(2), 2013.
//! <https://jcgt.org/published/0002/02/02/>
//!
//! # Jensen1995
//! H. W. Jensen: Importance Driven Path Tracing Using the Photon Map. Rendering Techniques (Eurographics Workshop), 1995.
//! <https://doi.org/10.1007/978-3-7091-9430-0_31>
//!
//! # Jensen1996
//! H. W. Jensen: Global Illumination using Photon Maps. Rendering Techniques (Eurographics Workshop on Rendering), 1996.
//! <https://doi.org/10.1007/978-3-7091-7484-5_3>
//!
//! # Jensen2001
//! H. W. Jensen: Realistic Image Synthesis Using Photon Mapping. A K Peters, 2001.
//!
//! # Kajiya1986
//! J. Kajiya: The Rendering Equation. SIGGRAPH, 1986. <https://doi.org/10.1145/15922.15902>
//!
//! # KastenYoung1989
//! F. Kasten, A. Young: Revised Optical Air Mass Tables and Approximation Formula. Applied Optics 28(22), 1989.
//! <https://doi.org/10.1364/AO.28.004735>
//!
//! # Knaus2011
//! C. Knaus, M. Zwicker: Progressive Photon Mapping: A Probabilistic Approach. ACM Transactions on Graphics 30(3), 2011.
//! <https://doi.org/10.1145/1966394.1966404>
//!
//! # KrochmannSeidl1974
//! J. Krochmann, M. Seidl: Quantitative Data on Daylight for Illuminating Engineering. Lighting Research and Technology 6(3),
//! 1974. <https://doi.org/10.1177/096032717400600302>
//!
//! # KhronosNeutral
//! Khronos Group: Khronos PBR Neutral Tone Mapper, 2024. <https://github.com/KhronosGroup/ToneMapping>
//!
//! # Krivanek2006
//! J. Křivánek, K. Bouatouch, S. Pattanaik, J. Žára: Making Radiance and Irradiance Caching Practical: Adaptive Caching and
//! Neighbor Clamping. Eurographics Symposium on Rendering, 2006.
//!
//! # Lafortune1994
//! E. Lafortune, Y. Willems: Using the Modified Phong Reflectance Model for Physically Based Rendering. Report CW 197,
//! Katholieke Universiteit Leuven, 1994.
//!
//! # Malley1988
//! T. Malley: A Shading Method for Computer Generated Images. Master's thesis, University of Utah, 1988.
//!
//! # Meister2018a
//! D. Meister, J. Bittner: Parallel Locally-Ordered Clustering for Bounding Volume Hierarchy Construction. IEEE Transactions on
//! Visualization and Computer Graphics 24(3), 2018. <https://doi.org/10.1109/TVCG.2017.2669983>
//!
//! # Meister2018b
//! D. Meister, J. Bittner: Parallel Reinsertion for Bounding Volume Hierarchy Optimization. Computer Graphics Forum 37(2),
//! 2018. <https://doi.org/10.1111/cgf.13382>
//!
//! # Michalsky1988
//! J. Michalsky: The Astronomical Almanac's Algorithm for Approximate Solar Position (1950-2050). Solar Energy 40(3), 1988.
//! <https://doi.org/10.1016/0038-092X(88)90045-X>
//!
//! # MoonSpencer1942
//! P. Moon, D. Spencer: Illumination from a Non-Uniform Sky. Transactions of the Illuminating Engineering Society 37, 1942.
//!
//! # Mitchell1987
//! D. Mitchell: Generating Antialiased Images at Low Sampling Densities. SIGGRAPH, 1987.
//! <https://doi.org/10.1145/37401.37410>
//!
//! # Muller2017
//! T. Müller, M. Gross, J. Novák: Practical Path Guiding for Efficient Light-Transport Simulation. Computer Graphics Forum
//! 36(4), 2017. <https://doi.org/10.1111/cgf.13227>
//!
//! # Neumaier1974
//! A. Neumaier: Rundungsfehleranalyse einiger Verfahren zur Summation endlicher Summen. Zeitschrift für Angewandte Mathematik
//! und Mechanik 54(1), 1974. <https://doi.org/10.1002/zamm.19740540106>
//!
//! # Neumann1995
//! L. Neumann: Monte Carlo Radiosity. Computing 55(1), 1995. <https://doi.org/10.1007/BF02238235>
//!
//! # NumericalRecipes
//! W. Press, S. Teukolsky, W. Vetterling, B. Flannery: Numerical Recipes, third edition. Cambridge University Press, 2007.
//!
//! # PNG3
//! W3C: Portable Network Graphics (PNG) Specification (Third Edition), 2025. <https://www.w3.org/TR/png-3/>
//!
//! # PBRT4
//! M. Pharr, W. Jakob, G. Humphreys: Physically Based Rendering, 4th edition. MIT Press, 2023. <https://pbr-book.org>
//!
//! # PieglTiller1997
//! L. Piegl, W. Tiller: The NURBS Book. 2nd edition. Springer, 1997. <https://doi.org/10.1007/978-3-642-59223-2>
//!
//! # Preetham1999
//! A. Preetham, P. Shirley, B. Smits: A Practical Analytic Model for Daylight. SIGGRAPH, 1999.
//! <https://doi.org/10.1145/311535.311545>
//!
//! # Reinhard2002
//! E. Reinhard, M. Stark, P. Shirley, J. Ferwerda: Photographic Tone Reproduction for Digital Images. ACM Transactions on
//! Graphics 21(3), 2002. <https://doi.org/10.1145/566654.566575>
//!
//! # Schlick1994
//! C. Schlick: An Inexpensive BRDF Model for Physically-Based Rendering. Computer Graphics Forum 13(3), 1994.
//! <https://doi.org/10.1111/1467-8659.1330233>
//!
//! # Schregle2003
//! R. Schregle: Bias Compensation for Photon Maps. Computer Graphics Forum 22(4), 2003.
//! <https://doi.org/10.1111/j.1467-8659.2003.00720.x>
//!
//! # Shirley1997
//! P. Shirley, K. Chiu: A Low Distortion Map Between Disk and Square. Journal of Graphics Tools 2(3), 1997.
//! <https://doi.org/10.1080/10867651.1997.10487479>
//!
//! # SillionPuech1989
//! F. Sillion, C. Puech: A General Two-Pass Method Integrating Specular and Diffuse Reflection. SIGGRAPH 1989.
//! <https://doi.org/10.1145/74334.74368>
//!
//! # Sparrow1963
//! E. Sparrow: A New and Simpler Formulation for Radiative Angle Factors. Journal of Heat Transfer 85(2), 1963.
//! <https://doi.org/10.1115/1.3686058>
//!
//! # Stafford2011
//! D. Stafford: Better Bit Mixing, 2011. <https://zimbry.blogspot.com/2011/09/better-bit-mixing-improving-on.html>
//!
//! # SteeleWhite1990
//! G. L. Steele, J. L. White: How to Print Floating-Point Numbers Accurately. Proceedings of PLDI, 1990.
//! <https://doi.org/10.1145/93542.93559>
//!
//! # Steffen1990
//! M. Steffen: A Simple Method for Monotonic Interpolation in One Dimension. Astronomy and Astrophysics 239, 1990, 443-450.
//! <https://ui.adsabs.harvard.edu/abs/1990A%26A...239..443S>
//!
//! # TakahasiMori1974
//! H. Takahasi, M. Mori: Double Exponential Formulas for Numerical Integration. Publications of the Research Institute for
//! Mathematical Sciences 9(3), 1974. <https://doi.org/10.2977/prims/1195192451>
//!
//! # Urena2013
//! C. Ureña, M. Fajardo, A. King: An Area-Preserving Parametrization for Spherical Rectangles. Computer Graphics Forum 32(4),
//! 2013. <https://doi.org/10.1111/cgf.12151>
//!
//! # Veach1997
//! E. Veach: Robust Monte Carlo Methods for Light Transport Simulation. Dissertation, Stanford University, 1997.
//! <https://graphics.stanford.edu/papers/veach_thesis/>
//!
//! # VeachGuibas1995
//! E. Veach, L. Guibas: Optimally Combining Sampling Techniques for Monte Carlo Rendering. SIGGRAPH, 1995.
//! <https://doi.org/10.1145/218380.218498>
//!
//! # Vegdahl2021
//! N. Vegdahl: Building a Better LK Hash, 2021. <https://psychopath.io/post/2021_01_30_building_a_better_lk_hash>
//!
//! # Vose1991
//! M. Vose: A Linear Algorithm for Generating Random Numbers with a Given Distribution. IEEE Transactions on Software
//! Engineering 17(9), 1991. <https://doi.org/10.1109/32.92917>
//!
//! # Walter2007
//! B. Walter, S. Marschner, H. Li, K. Torrance: Microfacet Models for Refraction through Rough Surfaces. Eurographics
//! Symposium on Rendering, 2007. <https://doi.org/10.2312/EGWR/EGSR07/195-206>
//!
//! # Wang2008
//! W. Wang, B. Jüttler, D. Zheng, Y. Liu: Computation of Rotation Minimizing Frames. ACM Transactions on Graphics 27(1), 2008.
//! <https://doi.org/10.1145/1330511.1330513>
//!
//! # Ward1988
//! G. Ward, F. Rubinstein, R. Clear: A Ray Tracing Solution for Diffuse Interreflection. SIGGRAPH, 1988.
//! <https://doi.org/10.1145/54852.378490>
//!
//! # WardHeckbert1992
//! G. Ward, P. Heckbert: Irradiance Gradients. Eurographics Workshop on Rendering, 1992.
//!
//! # WebpContainer
//! WebP Container Specification. <https://developers.google.com/speed/webp/docs/riff_container>
//!
//! # Welford1962
//! B. Welford: Note on a Method for Calculating Corrected Sums of Squares and Products. Technometrics 4(3), 1962.
//! <https://doi.org/10.1080/00401706.1962.10490022>
//!
//! # Whitted1980
//! T. Whitted: An Improved Illumination Model for Shaded Display. Communications of the ACM 23(6), 1980.
//! <https://doi.org/10.1145/358876.358882>
//!
//! # Woop2013
//! S. Woop, C. Benthin, I. Wald: Watertight Ray/Triangle Intersection. Journal of Computer Graphics Techniques 2(1), 2013.
//! <https://jcgt.org/published/0002/01/05/>
//!
//! # Wyman2013
//! C. Wyman, P.-P. Sloan, P. Shirley: Simple Analytic Approximations to the CIE XYZ Color Matching Functions. Journal of
//! Computer Graphics Techniques 2(2), 2013. <https://jcgt.org/published/0002/02/01/>
//!
//! # Yuksel2011
//! C. Yuksel, S. Schaefer, J. Keyser: Parameterization and Applications of Catmull–Rom Curves. Computer-Aided Design 43(7),
//! 2011. <https://doi.org/10.1016/j.cad.2010.08.008>

#![expect(
    clippy::doc_markdown,
    reason = "headings are keys and names are names, not code"
)]
