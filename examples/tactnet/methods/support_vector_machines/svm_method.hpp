#pragma once

// A support vector machine as a method, whatever the features in front of it.

#include "methods/method.hpp"
#include "methods/support_vector_machines/image_features.hpp"
#include "methods/support_vector_machines/recipe.hpp"

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>

class svm_method : public method {
public:
    using feature_maker = std::function<std::unique_ptr<image_features>()>;

    svm_method(const svm_recipe& recipe, std::size_t rows_, std::size_t columns_, feature_maker features);

    bool is_network() const override { return false; }
    tactnet::file_metadata parts() const override;
    /// Of a support vector machine trained on the paper's number of images of each class, which all are
    /// support vectors at the worst.
    method_costs costs(std::size_t classes) const override;
    frame_work make_work(std::size_t bits) const override;
    std::unique_ptr<training_run> train(const tactnet::recipe&, const tactnet::labelled_images& images,
                                        tactnet::data_split split, std::uint64_t,
                                        tactnet::thread_pool& threads,
                                        const std::shared_ptr<pretrained_weights>& from) const override;
    std::unique_ptr<trained_method> load(const weight_file& from, std::optional<double>) const override;

protected:
    static constexpr std::size_t images_of_class = 32;

    const svm_recipe& recipe() const { return recipe_; }
    std::unique_ptr<training_run> train_on(std::unique_ptr<image_features> features,
                                           const tactnet::labelled_images& images, tactnet::data_split split,
                                           tactnet::thread_pool& threads) const;

private:
    const svm_recipe& recipe_;
    feature_maker features_;
};
