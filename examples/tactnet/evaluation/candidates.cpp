#include "evaluation/candidates.hpp"

#include "methods/description.hpp"
#include "methods/registry.hpp"
#include "methods/weights.hpp"
#include "usage_error.hpp"

#include <tactnet/io/file_error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <set>

namespace {

/// How many there are does not depend on the rule or the seed.
void check_test_images(const std::filesystem::path& folder, const training_settings& training,
                       const image_data& data) {
    const auto split = tactnet::split_data(data.images.labels, data.images.classes.size(),
                                           tactnet::split_rule::random, 0, training.shares);
    if (split.test.empty())
        throw tactnet::file_error(
            folder.string(), "",
            fmt::format("enough images for a test, of which --test takes a share of {}",
                        training.shares.test),
            fmt::format("{} of {} classes", data.images.size(), data.images.classes.size()));
}

} // namespace

void check_seeds(const split_plan& plan) {
    if (plan.splits - 1 > std::numeric_limits<std::uint64_t>::max() - plan.first_seed)
        throw usage_error(fmt::format("--seed, --splits: expected seeds below 2^64 for all splits, found {} "
                                      "of them from {} on",
                                      plan.splits, plan.first_seed));
}

candidate_list::candidate_list(const std::filesystem::path& data, std::vector<candidate> chosen)
    : list_(std::move(chosen)) {
    for (candidate& c : list_) {
        const std::pair size{c.what->rows, c.what->columns};
        if (!data_.contains(size))
            data_.emplace(size, load_data(data, size.first, size.second, c.training.resize));
        c.data = &data_.at(size);
        check_capacity(*c.what, data.string(), c.data->images.classes.size());
        check_test_images(data, c.training, *c.data);
        c.start = load_start(*c.what, c.training, c.data->images.classes);
        c.pretrained = open_pretrained(*c.what, c.training);
    }
}

std::vector<task> tasks_of(const candidate_list& candidates, const split_plan& plan) {
    std::vector<task> all;
    for (std::size_t split = 0; split < plan.splits; ++split)
        for (const candidate& c : candidates)
            for (const tactnet::split_rule rule : plan.rules) {
                const std::uint64_t seed = plan.first_seed + split;
                all.push_back({&c, rule, seed, describe_training(*c.what, c.training, rule, seed, *c.data)});
            }
    return all;
}

bool train_all(const std::vector<task>& to_do, std::size_t jobs, result_list& results,
               std::vector<std::string>* diverged) {
    std::set<const candidate*> with_features;
    for (const task& t : to_do)
        if (t.of->pretrained)
            with_features.insert(t.of);
    if (!with_features.empty()) {
        tactnet::thread_pool pool(jobs);
        const auto folder = results.path().parent_path() / "features";
        for (const candidate* c : with_features)
            if (!c->pretrained->prepare(*c->data, {folder, true}, pool))
                return false;
    }
    return to_do.empty() || run_all(to_do, jobs, results, diverged);
}
