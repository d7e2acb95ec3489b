#include "pattern/motion/excitation.h"

#include "core/check.h"

#include <fftw3.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <mutex>
#include <numbers>

namespace fantascope::pattern {
namespace {

using Spectrum = std::vector<std::complex<double>>;

fftw_complex* fftwBins(Spectrum& spectrum) { return reinterpret_cast<fftw_complex*>(spectrum.data()); }

// FFTW's planner has global state; only executing a plan is reentrant.
std::mutex& plannerMutex() {
    static std::mutex mutex;
    return mutex;
}

}  // namespace

// The inverse Fourier transform of a conjugate-symmetric spectrum: bins 0 .. frames / 2 in,
// `frames` real samples out.
class Excitation::InverseTransform {
public:
    explicit InverseTransform(int frames) {
        Spectrum spectrum(static_cast<std::size_t>(frames) / 2 + 1);
        std::vector<double> samples(static_cast<std::size_t>(frames));
        const std::lock_guard lock(plannerMutex());
        // FFTW_ESTIMATE: the plan does not depend on measured times. FFTW_UNALIGNED: the result
        // does not depend on the memory's alignment. Both keep results reproducible.
        plan_ = fftw_plan_dft_c2r_1d(frames, fftwBins(spectrum), samples.data(), FFTW_ESTIMATE | FFTW_UNALIGNED);
        FANTASCOPE_CHECK(plan_ != nullptr, "FFTW has a plan for every length");
    }
    ~InverseTransform() {
        const std::lock_guard lock(plannerMutex());
        fftw_destroy_plan(plan_);
    }
    InverseTransform(const InverseTransform&) = delete;
    InverseTransform& operator=(const InverseTransform&) = delete;

    // The conjugate half is implied. FFTW overwrites the spectrum.
    void operator()(Spectrum& spectrum, std::vector<double>& samples) const {
        fftw_execute_dft_c2r(plan_, fftwBins(spectrum), samples.data());
    }

private:
    fftw_plan plan_;
};

Excitation::Excitation(double beta, int frames, double rate, double deviation) : frames_(frames), deviation_(deviation) {
    FANTASCOPE_CHECK(frames >= 4 && frames % 2 == 0, "an excitation needs an even number of frames, 4 or more");
    FANTASCOPE_CHECK(beta >= 0 && rate > 0 && deviation >= 0, "an excitation's parameters are out of range");
    // Step 1: bin 0 is zero, so that shapes fluctuate around their rest.
    // Step 2: bin i stands for the frequency i * frequencyStep.
    const double frequencyStep = rate / frames;
    meanAmplitude_.assign(static_cast<std::size_t>(frames) / 2 + 1, 0.0);
    for (std::size_t i = 1; i < meanAmplitude_.size(); ++i)
        meanAmplitude_[i] = std::pow(static_cast<double>(i) * frequencyStep, -beta);
    inverse_ = std::make_unique<const InverseTransform>(frames);
}

Excitation::Excitation(Excitation&&) noexcept = default;
Excitation::~Excitation() = default;

std::vector<double> Excitation::draw(Rng& rng) const {
    const std::size_t bins = meanAmplitude_.size();
    // Step 3: amplitudes scattered about their means, never negative.
    std::vector<double> amplitude(bins, 0.0);
    for (std::size_t i = 1; i < bins; ++i) amplitude[i] = std::max(0.0, meanAmplitude_[i] * (1.0 + deviation_ * rng.normal()));
    // Step 4: uniform phases.
    Spectrum spectrum(bins);
    for (std::size_t i = 1; i < bins; ++i)
        spectrum[i] = std::polar(amplitude[i], rng.uniform(-std::numbers::pi, std::numbers::pi));
    // The last bin is its own conjugate, so it must be real. It keeps its amplitude and takes the
    // sign of its real part.
    spectrum.back() = std::copysign(amplitude.back(), spectrum.back().real());
    // Step 5: the conjugate half and the inverse transform.
    std::vector<double> samples(static_cast<std::size_t>(frames_));
    (*inverse_)(spectrum, samples);

    double peak = 0;
    for (const double sample : samples) peak = std::max(peak, std::abs(sample));
    if (peak > 0)  // a large deviation can silence every bin of a very short excitation
        for (double& sample : samples) sample /= peak;
    return samples;
}

}  // namespace fantascope::pattern
