#pragma once

#include <tactnet/detail/config.hpp>

#include <cstddef>
#include <vector>

// The input and output of a solver: two classes, and a machine that separates them.

namespace tactnet {
inline namespace TACTNET_ARCH {

/// Two classes: the samples, their sides, and the cost of an error on each.
struct binary_problem {
    std::vector<std::size_t> samples;
    std::vector<double> sides; ///< +1 or −1
    std::vector<double> costs; ///< C of the sample
};

/// The outcome of a solver.
struct solver_report {
    std::size_t iterations = 0;
    bool converged = false; ///< otherwise the limit was reached; the machine is usable, if not the best
    double violation = 0;   ///< of the optimality conditions
    double objective = 0;   ///< of the dual, as a minimum: ½ βᵀ K β − Σ y β
};

/// f(x) = Σ coefficients · K(sample, x) + offset
struct binary_solution {
    std::vector<double> coefficients;
    double offset = 0;
    solver_report report;
};

} // namespace TACTNET_ARCH
} // namespace tactnet
