#include "liblinear.hpp"

#include "sparse_rows.hpp"

#include <linear.h>

namespace benchmark {

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
