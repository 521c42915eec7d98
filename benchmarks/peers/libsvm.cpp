#include "libsvm.hpp"

#include "sparse_rows.hpp"

#include <cmath>
#include <libsvm/svm.h>

namespace benchmark {

struct libsvm_machine::model {
    sparse_rows<svm_node> rows;
    std::vector<double> labels;
    double gamma;
    svm_model* trained = nullptr;
};

libsvm_machine::libsvm_machine(tactnet::feature_rows<> rows, std::span<const std::size_t> labels,
                               double gamma, double cost)
    : model_(
          new model{sparse_rows<svm_node>(rows), std::vector<double>(labels.begin(), labels.end()), gamma}) {
    svm_set_print_string_function([](const char*) {});
    const svm_problem problem{static_cast<int>(rows.size()), model_->labels.data(), model_->rows.data()};
    svm_parameter parameter{};
    parameter.svm_type = C_SVC;
    parameter.kernel_type = RBF;
    parameter.gamma = gamma;
    parameter.C = cost;
    parameter.eps = 1e-3;
    parameter.cache_size = 256;
    parameter.shrinking = 1;
    model_->trained = svm_train(&problem, &parameter);
}

libsvm_machine::~libsvm_machine() {
    svm_free_and_destroy_model(&model_->trained);
}

std::vector<std::size_t> libsvm_machine::predict(tactnet::feature_rows<> rows) const {
    const sparse_rows<svm_node> sparse(rows);
    std::vector<std::size_t> labels;
    for (std::size_t i = 0; i < sparse.size(); ++i)
        labels.push_back(static_cast<std::size_t>(svm_predict(model_->trained, sparse[i])));
    return labels;
}

double libsvm_machine::objective() const {
    const svm_model& m = *model_->trained;
    const auto kernel = [&](const svm_node* a, const svm_node* b) {
        double squares = 0;
        while (a->index != -1 || b->index != -1) {
            const bool from_a = b->index == -1 || (a->index != -1 && a->index <= b->index);
            const bool from_b = a->index == -1 || (b->index != -1 && b->index <= a->index);
            const double d = (from_a ? a->value : 0) - (from_b ? b->value : 0);
            squares += d * d;
            a += from_a ? 1 : 0;
            b += from_b ? 1 : 0;
        }
        return std::exp(-model_->gamma * squares);
    };
    const auto count = static_cast<std::size_t>(m.l);
    std::vector<double> kernels(count * count);
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t j = 0; j <= i; ++j)
            kernels[i * count + j] = kernels[j * count + i] = kernel(m.SV[i], m.SV[j]);

    double sum = 0;
    std::vector<std::size_t> begin(1, 0);
    for (int c = 0; c < m.nr_class; ++c)
        begin.push_back(begin.back() + static_cast<std::size_t>(m.nSV[c]));
    for (int first = 0; first < m.nr_class; ++first)
        for (int second = first + 1; second < m.nr_class; ++second) {
            std::vector<std::size_t> members;
            std::vector<double> beta;
            const auto add = [&](int own, const double* coefficients) {
                for (std::size_t v = begin[static_cast<std::size_t>(own)];
                     v < begin[static_cast<std::size_t>(own) + 1]; ++v) {
                    members.push_back(v);
                    beta.push_back(coefficients[v]);
                }
            };
            add(first, m.sv_coef[second - 1]);
            add(second, m.sv_coef[first]);
            for (std::size_t i = 0; i < members.size(); ++i) {
                sum -= std::abs(beta[i]);
                for (std::size_t j = 0; j < members.size(); ++j)
                    sum += beta[i] * beta[j] * kernels[members[i] * count + members[j]] / 2;
            }
        }
    return sum;
}

std::size_t libsvm_machine::support_vectors() const {
    return static_cast<std::size_t>(model_->trained->l);
}

} // namespace benchmark
