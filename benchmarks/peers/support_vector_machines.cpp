#include "support_vector_machines.hpp"

#include <cmath>
#include <libsvm/svm.h>
#include <linear.h>

namespace benchmark {

namespace {

/// Rows as LIBSVM and LIBLINEAR take them: indices from 1 and values of what is not zero, and an index of −1
/// at the end. `bias` other than 0 follows the last feature.
template <class Node>
class sparse_rows {
public:
    explicit sparse_rows(tactnet::feature_rows<> rows, double bias = 0) {
        std::vector<std::size_t> begins;
        for (std::size_t i = 0; i < rows.size(); ++i) {
            begins.push_back(nodes_.size());
            for (std::size_t f = 0; f < rows.features(); ++f)
                if (const float value = rows.row(i)[f]; value != 0)
                    nodes_.push_back({static_cast<int>(f + 1), static_cast<double>(value)});
            if (bias != 0)
                nodes_.push_back({static_cast<int>(rows.features() + 1), bias});
            nodes_.push_back({-1, 0});
        }
        for (const std::size_t begin : begins)
            rows_.push_back(nodes_.data() + begin);
    }
    // Rows are places in the nodes.
    sparse_rows(const sparse_rows&) = delete;
    sparse_rows& operator=(const sparse_rows&) = delete;

    [[nodiscard]] std::size_t size() const { return rows_.size(); }
    [[nodiscard]] Node** data() { return rows_.data(); }
    [[nodiscard]] const Node* operator[](std::size_t index) const { return rows_[index]; }

private:
    std::vector<Node> nodes_;
    std::vector<Node*> rows_;
};

} // namespace

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

struct liblinear_machine::model {
    sparse_rows<feature_node> rows;
    std::vector<double> labels;
    ::model* trained = nullptr;
};

liblinear_machine::liblinear_machine(tactnet::feature_rows<> rows, std::span<const std::size_t> labels,
                                     tactnet::linear_loss loss, double cost, double tolerance)
    : model_(
          new model{sparse_rows<feature_node>(rows, 1), std::vector<double>(labels.begin(), labels.end())}) {
    set_print_string_function([](const char*) {});
    problem all{};
    all.l = static_cast<int>(rows.size());
    all.n = static_cast<int>(rows.features() + 1);
    all.y = model_->labels.data();
    all.x = model_->rows.data();
    all.bias = 1;
    parameter how{};
    how.solver_type = loss == tactnet::linear_loss::hinge ? L2R_L1LOSS_SVC_DUAL : L2R_L2LOSS_SVC_DUAL;
    how.C = cost;
    how.eps = tolerance;
    model_->trained = train(&all, &how);
}

liblinear_machine::~liblinear_machine() {
    free_and_destroy_model(&model_->trained);
}

std::vector<std::size_t> liblinear_machine::predict(tactnet::feature_rows<> rows) const {
    const sparse_rows<feature_node> sparse(rows, 1);
    std::vector<std::size_t> labels;
    for (std::size_t i = 0; i < sparse.size(); ++i)
        labels.push_back(static_cast<std::size_t>(::predict(model_->trained, sparse[i])));
    return labels;
}

std::vector<double> liblinear_machine::weights(std::size_t index) const {
    const ::model& m = *model_->trained;
    std::vector<double> result;
    for (int f = 0; f <= m.nr_feature; ++f)
        result.push_back(m.w[static_cast<std::size_t>(f) * static_cast<std::size_t>(m.nr_class) + index]);
    return result;
}

} // namespace benchmark
