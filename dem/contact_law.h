#pragma once

namespace dem
{
  /** Whether S_q is the roughness of a pair or of one grain (then S = sqrt(Sq_a^2 + Sq_b^2)). */
  enum class RoughnessRule
  {
    combined,
    per_grain
  };

  /** What a grain's surface is made of. */
  struct GrainMaterial
  {
    double shear_modulus = 32e9; ///< G [Pa]
    double poisson_ratio = 0.19; ///< nu [-]
    double friction = 0.275;     ///< mu [-]
    double roughness = 0.6e-6;   ///< S_q [m]; 0: smooth
    RoughnessRule roughness_rule = RoughnessRule::combined;
    double n1 = 0.05;          ///< first roughness parameter [-]
    double n2 = 5.;            ///< second roughness parameter [-]
    double wall_friction = 0.; ///< mu between a grain and a rigid wall [-]
  };

  /**
   * Constants of the three-stage contact of rough spheres (Otsubo et al. 2017, docs/theory.md Eq. 1-7). With the
   * overlap in units of S they depend on n1 and n2 alone; only the forces carry sqrt(R*).
   */
  struct ContactLaw
  {
    double effective_modulus = 0.; ///< E* [Pa]
    double friction = 0.;          ///< mu [-]
    double shear_ratio = 0.;       ///< kt/kn = 2 (1 - nu)/(2 - nu) [-]
    double roughness = 0.;         ///< S of the pair [m]; 0: plain Hertz
    double b = 1.5, c = 1.5;       ///< exponents of the transition and of the asperities [-]
    double d1 = 0., d2 = 0.;       ///< n1 S, n2 S [m]
    double dT1 = 0., dT2 = 0.;     ///< overlaps at which a stage ends [m]
    double force_scale_1 = 0.;     ///< N1 / sqrt(R*) [N/m^0.5]
    double force_scale_2 = 0.;     ///< N2 / sqrt(R*) [N/m^0.5]
    double wall_friction = 0.;     ///< mu of a wall [-]
    double wall_roughness = 0.;    ///< S of a grain and a wall [m]
  };

  /** Normal force and its derivative at one contact. */
  struct NormalResponse
  {
    double force;     ///< N [N], compression-positive
    double stiffness; ///< kn = dN/dd [N/m]
  };

  /** @pre moduli positive, 0 <= nu <= 0.5, roughness >= 0, n1, n2 >= 0 */
  ContactLaw make_contact_law(const GrainMaterial &material);

  /**
   * The law between a grain and a rigid, smooth wall (docs/theory.md Eq. 2.14): E* is twice that of two grains, S is
   * S_q by either rule, mu that of the wall; kt/kn is the same. R* is the radius of the grain.
   */
  ContactLaw make_wall_law(const ContactLaw &law);

  /** R* = Ra Rb / (Ra + Rb) [m]. */
  inline double compute_effective_radius(double radius_a, double radius_b)
  {
    return radius_a * radius_b / (radius_a + radius_b);
  }

  /**
   * Normal force at an overlap, the readable reference of the law (docs/theory.md Eq. 1-7). Zero force and stiffness at
   * overlap <= 0: freshly split siblings are tangent.
   *
   * @param overlap           d [m], positive when touching
   * @param effective_radius  R* [m]
   */
  NormalResponse compute_normal_response(const ContactLaw &law, double overlap, double effective_radius);

  /** Energy stored on loading to an overlap, the integral of N from 0 to d in closed form [J]. */
  double compute_stored_energy(const ContactLaw &law, double overlap, double effective_radius);
} // namespace dem
