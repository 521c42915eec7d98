#pragma once

// Support vector machines of other libraries, to compare with.

#include <tactnet/svm/feature_rows.hpp>
#include <tactnet/svm/solvers/coordinate_descent.hpp>

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

/// A linear machine with offset trained by LIBLINEAR's dual coordinate descent.
class liblinear_machine {
public:
    liblinear_machine(tactnet::feature_rows<> rows, std::span<const std::size_t> labels,
                      tactnet::linear_loss loss, double cost, double tolerance);
    ~liblinear_machine();

    [[nodiscard]] std::vector<std::size_t> predict(tactnet::feature_rows<> rows) const;
    /// Weights of a class by its place, the offset last.
    [[nodiscard]] std::vector<double> weights(std::size_t index) const;

private:
    struct model;
    std::unique_ptr<model> model_;
};

} // namespace benchmark
