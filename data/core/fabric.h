#pragma once

namespace cloth {

/// Material of a garment. The Lame constants are those of the sheet (N/m): the bulk constant (Pa)
/// times the thickness, multiplied once and for all so that no formula multiplies them again.
struct Fabric {
    double density = 0.20022;  ///< mass per area (kg/m^2), 1e-3 to 1e3; cloth has 0.03 to 1
    double mu = 11.1;          ///< shear modulus of the sheet (N/m), 0 to 1e6; cloth: 1 to 1e4
    double lambda = 20.9;  ///< first Lame constant of the sheet (N/m), 0 to 1e6; cloth: 1 to 1e4
    double bending = 3.96e-5;  ///< dihedral bending stiffness (N m), 0 to 1; cloth: 1e-8 to 1e-2

    /// SNUG's cotton: the soft fabric that learned cloth is usually trained on, 33 N/m.
    static Fabric soft_cotton() { return {}; }
    /// Cotton as it is measured: Young's modulus 5 kN/m, Poisson's ratio 0.3.
    static Fabric real_cotton() {
        const double young = 5000.0, poisson = 0.3;
        return {0.2, young / (2.0 * (1.0 + poisson)), young * poisson / (1.0 - poisson * poisson),
                2e-5};
    }
    /// Longitudinal stiffness 2 mu + lambda (N/m): the fastest in-plane wave.
    double longitudinal() const { return 2.0 * mu + lambda; }
};

}  // namespace cloth
