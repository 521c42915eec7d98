#include "methods/support_vector_machines/method.hpp"

#include "methods/support_vector_machines/pixel_features.hpp"
#include "methods/support_vector_machines/recipe.hpp"
#include "methods/support_vector_machines/svm_method.hpp"

#include <utility>

std::vector<std::unique_ptr<method>> make_svm_methods(std::size_t rows, std::size_t columns,
                                                      std::unique_ptr<image_features> (*surf)()) {
    std::vector<std::unique_ptr<method>> list;
    for (const svm_recipe& recipe : svm_recipes()) {
        svm_method::feature_maker features = surf;
        if (recipe.pixel_scale > 0)
            features = [=]() -> std::unique_ptr<image_features> {
                return std::make_unique<pixel_features>(rows * columns, recipe.pixel_scale);
            };
        list.push_back(std::make_unique<svm_method>(recipe, rows, columns, std::move(features)));
    }
    return list;
}
