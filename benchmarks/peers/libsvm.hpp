#pragma once

#include <tactnet/svm/feature_rows.hpp>

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace benchmark {

/// A machine with the RBF kernel trained by LIBSVM, one versus one, at its default tolerance.
class libsvm_machine {
public:
    libsvm_machine(tactnet::feature_rows<> rows, std::span<const std::size_t> labels, double gamma,
                   double cost);
    ~libsvm_machine();

    [[nodiscard]] std::vector<std::size_t> predict(tactnet::feature_rows<> rows) const;
    /// The sum of the dual objectives of all pairs, from the coefficients, in double.
    [[nodiscard]] double objective() const;
    [[nodiscard]] std::size_t support_vectors() const;

private:
    struct model;
    std::unique_ptr<model> model_;
};

} // namespace benchmark
