#pragma once

#include <tactnet/svm/feature_rows.hpp>

#include <cstddef>
#include <vector>

namespace benchmark {

/// Rows as LIBSVM and LIBLINEAR take them: indices from 1 and values of what is not zero, and an index of −1
/// behind. `bias` other than 0 goes behind the last feature.
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

} // namespace benchmark
