// A stand-in for pbrt-v4's header of this name: the shapes of its public types that a BxDF meets, and no more.
#pragma once
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>

#define PBRT_CPU_GPU

namespace pstd {
using std::optional;
}

namespace pbrt {

using Float = float;
static constexpr int NSpectrumSamples = 4;

struct Vector3f {
    Float x = 0, y = 0, z = 0;
    Vector3f() = default;
    Vector3f(Float x, Float y, Float z) : x(x), y(y), z(z) {}
};

struct Point2f {
    Float x = 0, y = 0;
    Point2f() = default;
    Point2f(Float x, Float y) : x(x), y(y) {}
    Float operator[](int i) const { return i == 0 ? x : y; }
};

class SampledSpectrum {
  public:
    SampledSpectrum() = default;
    explicit SampledSpectrum(Float c) {
        for (Float &v : values) { v = c; }
    }
    Float operator[](int i) const { return values[i]; }
    Float &operator[](int i) { return values[i]; }

  private:
    Float values[NSpectrumSamples] = {};
};

class SampledWavelengths {
  public:
    // pbrt draws them; a test names them.
    explicit SampledWavelengths(const Float *nm) {
        for (int i = 0; i < NSpectrumSamples; ++i) { lambda[i] = nm[i]; }
    }
    Float operator[](int i) const { return lambda[i]; }

  private:
    Float lambda[NSpectrumSamples];
};

enum class TransportMode { Radiance, Importance };
enum class BxDFReflTransFlags { Unset = 0, Reflection = 1, Transmission = 2, All = 3 };
inline int operator&(BxDFReflTransFlags a, BxDFReflTransFlags b) { return int(a) & int(b); }
enum BxDFFlags { Unset = 0, Reflection = 1, Transmission = 2, Diffuse = 4, Glossy = 8, Specular = 16 };
inline BxDFFlags operator|(BxDFFlags a, BxDFFlags b) { return BxDFFlags(int(a) | int(b)); }

struct BSDFSample {
    BSDFSample(SampledSpectrum f, Vector3f wi, Float pdf, BxDFFlags flags, Float eta = 1, bool pdfIsProportional = false)
        : f(f), wi(wi), pdf(pdf), flags(flags), eta(eta), pdfIsProportional(pdfIsProportional) {}
    SampledSpectrum f;
    Vector3f wi;
    Float pdf = 0;
    BxDFFlags flags;
    Float eta = 1;
    bool pdfIsProportional = false;
};

}  // namespace pbrt
