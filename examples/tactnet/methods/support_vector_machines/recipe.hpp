#pragma once

#include "methods/support_vector_machines/machine.hpp"

#include <array>
#include <string_view>
#include <variant>

/// Of a support vector machine: which one, what it is trained with and what stands before it.
struct svm_recipe {
    std::string_view name;
    std::variant<linear_options, product_options, pair_options, rbf_options> options;
    float pixel_scale = 0; ///< 0: no pixels

    /// Whether it keeps a row of weights for each class, and no support vectors.
    bool has_weights() const {
        return std::holds_alternative<linear_options>(options) ||
               std::holds_alternative<product_options>(options);
    }

    /// All but the images that decides what comes of a training, features apart.
    tactnet::file_metadata describe() const;
};

const std::array<svm_recipe, 3>& svm_recipes();
