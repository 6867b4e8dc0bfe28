#pragma once

#include <array>
#include <cstddef>

namespace osgTerrainLight
{

/// [row][column]; row l·(l + 1) + m of the spherical harmonics of order 4
/// (shaders/lib/legendre.glsl has their definition), column: coefficients in normalised Legendre
/// polynomials.
template <std::size_t columns>
using ShMatrix = std::array<std::array<double, columns>, 16>;

/// How the functions of elevation at equally spaced azimuths (slices) become one of direction.
enum class AzimuthBlend
{
    Linear,
    /// Uniform cubic B-spline: smoother, but it does not pass through the slices.
    BSpline
};

/// What a slice's share of azimuth leaves of each |m| = 0 … 3: with h(φ) the weight of a slice at
/// φ from its own azimuth, even[m] = ∫ h cos mφ dφ, odd[m] = ∫ h sin mφ dφ. For addSlice.
struct AzimuthWeights
{
    std::array<double, 4> even = {};
    std::array<double, 4> odd = {};
};

/// Slices in four normalised Legendre polynomials to spherical harmonics of order 4 (NS09, section
/// 6 and appendix), by quadrature.
///
/// A wedge reaches from one azimuth to the next. Summed over all wedges, every slice w_j enters
/// through the two (four) wedges about it, so that
///     Σ wedges = Σ_j Rot_z(φ_j) K w_j,    K = folded(blend), 16×4,
/// K[(l, m)][c] = even[|m|] · ∫ N_l|m|(z) P̂_c(z) dz for m ≥ 0, and 0 for m < 0, since h is even.
/// The integral depends on neither spacing nor blend: a shader needs the four numbers `even` alone.
/// Where azimuths span a part of the circle (m azimuths, m − 1 wedges), the first and the last
/// slice have half of h, and their odd part stays.
class WedgeMatrices
{
public:
    /// spacing [rad] of neighbouring azimuths, 0 < spacing ≤ 2π/3; 2π/m on the full circle.
    explicit WedgeMatrices(double spacing);

    double spacing() const { return _spacing; }

    /// Wedge of azimuths 0 … spacing from the slices at 0 (columns 0 … 3) and at spacing (4 … 7).
    ShMatrix<8> linear() const;
    /// The same from the slices at −spacing, 0, spacing and 2·spacing.
    ShMatrix<16> bspline() const;

    /// K, for a slice at azimuth 0 within all the wedges it takes part in.
    ShMatrix<4> folded(AzimuthBlend blend) const;
    /// K for the ends of a partial range, linear: the wedge after the first slice, and the one
    /// before the last.
    ShMatrix<4> foldedFirst() const;
    ShMatrix<4> foldedLast() const;

    /// K without the integrals over z.
    AzimuthWeights weights(AzimuthBlend blend) const;
    AzimuthWeights firstWeights() const;
    AzimuthWeights lastWeights() const;

    /// ∫ N_lm(z) P̂_c(z) dz over −1 … 1, c = 0 … 3, 0 ≤ m ≤ l ≤ 3; Y_l,±m = N_lm(cos θ) · (cos or
    /// sin mφ).
    static const std::array<double, 4>& elevationIntegrals(int l, int m);

private:
    /// ∫ β(φ/spacing) e^{imφ} dφ over the wedge, for each of the blend's basis functions.
    using Moments = std::array<AzimuthWeights, 4>;
    static ShMatrix<4> matrixOf(const AzimuthWeights& weights);

    double _spacing;
    Moments _linear;
    Moments _bspline;
};

} // namespace osgTerrainLight
