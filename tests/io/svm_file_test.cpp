#include <tactnet/io/svm_file.hpp>
#include <tactnet/runtime/random.hpp>
#include <tactnet/svm/kernel_training.hpp>

#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <support/error_of.hpp>
#include <support/files/temporary_folder.hpp>
#include <vector>

using namespace tactnet;

namespace {

struct samples {
    std::vector<float> values;
    std::vector<std::size_t> labels;

    samples() {
        random_stream random(1, random_purposes::order);
        for (std::size_t i = 0; i < 60; ++i) {
            labels.push_back(10 + i % 3);
            for (std::size_t f = 0; f < 4; ++f)
                values.push_back(
                    static_cast<float>(random.normal() + 2 * static_cast<double>(i % 3 == f ? 1 : 0)));
        }
    }
    [[nodiscard]] feature_rows<4> rows() const { return feature_rows<4>(values); }
};

template <class Kernel>
void check_round_trip(const kernel_training_options<Kernel>& options) {
    const samples s;
    thread_pool alone;
    const auto machine = train_kernel_machine(s.rows(), s.labels, options, alone).machine;
    const support::temporary_folder folder;
    save_machine(folder.path() / "machine.safetensors", machine, {{"classes", "[\"a\",\"b\",\"c\"]"}});
    const auto file = safetensors::read(folder.path() / "machine.safetensors");
    CHECK(file.metadata().at("classes") == "[\"a\",\"b\",\"c\"]");
    const auto loaded = load_kernel_machine<Kernel, 4>(file);
    CHECK(loaded.decision_values(s.rows(), alone) == machine.decision_values(s.rows(), alone));
    CHECK(loaded.predict(s.rows(), alone) == machine.predict(s.rows(), alone));
    if (options.probability_folds > 0)
        CHECK(loaded.probabilities(s.rows(), alone) == machine.probabilities(s.rows(), alone));
}

/// What loading says of a file that was changed.
template <class Change>
std::string error_of(const Change& change) {
    safetensors_writer writer;
    writer.metadata = {{"format", "tactnet"},
                       {"version", "1"},
                       {"machine", "kernel"},
                       {"kernel", "rbf"},
                       {"multiclass", "one versus one"}};
    struct {
        std::vector<std::int64_t> labels{3, 8}, counts{1, 1};
        std::vector<float> vectors{1, 2, 3, 4};
        std::vector<double> coefficients{1, -1}, offsets{0.5}, gamma{0.5};
    } parts;
    change(writer, parts);
    const auto add = [&](const char* name, std::vector<std::size_t> extents, const auto& values) {
        using value = typename std::decay_t<decltype(values)>::value_type;
        writer.add(name, std::move(extents), std::span<const value>(values));
    };
    add("labels", {parts.labels.size()}, parts.labels);
    add("support_counts", {parts.counts.size()}, parts.counts);
    add("support_vectors", {parts.vectors.size() / 2, 2}, parts.vectors);
    add("coefficients", {parts.coefficients.size(), 1}, parts.coefficients);
    add("offsets", {parts.offsets.size()}, parts.offsets);
    if (!parts.gamma.empty())
        add("gamma", {}, parts.gamma);
    return support::error_of<file_error>([&] {
        static_cast<void>(load_kernel_machine<rbf_kernel>(safetensors::parse(writer.to_bytes(), "file")));
    });
}

} // namespace

TEST_CASE("svm_file: a machine that is loaded gives the bits of the one saved") {
    check_round_trip<rbf_kernel>({.cost = 3, .probability_folds = 3});
    check_round_trip<rbf_kernel>({.kernel = {0.0}});
    check_round_trip<rbf_kernel>(
        {.kernel = {1.0 / 3}, .scheme = multiclass::one_versus_rest, .standardise = true});
    check_round_trip<linear_kernel>({.standardise = true});
    const samples s;
    thread_pool alone;
    for (const bool standardise : {false, true}) {
        const auto machine =
            train_linear_machine(s.rows(), s.labels, {.standardise = standardise}, alone).machine;
        const support::temporary_folder folder;
        save_machine(folder.path() / "linear.safetensors", machine);
        const auto loaded = load_linear_machine<4>(folder.path() / "linear.safetensors");
        CHECK(loaded.decision_values(s.rows()) == machine.decision_values(s.rows()));
        const auto file = safetensors::parse(read_file(folder.path() / "linear.safetensors"), "file");
        CHECK_THROWS_WITH_AS((void)load_linear_machine<5>(file), "file: expected 5 features, found 4",
                             file_error);
        CHECK_THROWS_WITH_AS((void)load_kernel_machine<rbf_kernel>(file),
                             "file: metadata 'machine': expected 'kernel', found 'linear'", file_error);
    }
}

TEST_CASE("svm_file: a machine among other arrays; standardisation by nothing is refused") {
    linear_machine_parameters parts;
    parts.features = 2;
    parts.labels = {0, 1};
    parts.weights = {1, 2, 3, 4};
    parts.offsets = {5, 6};
    for (const float deviation : {0.5F, 0.0F, -1.0F}) {
        parts.standardise = standardisation{{0, 0}, {1, deviation}};
        safetensors_writer writer;
        writer.metadata["classes"] = "[]";
        writer.add("own", {1}, std::vector<float>{7});
        add_machine(writer, linear_machine<>(parts));
        CHECK(writer.metadata.at("classes") == "[]");
        const auto file = safetensors::parse(writer.to_bytes(), "file");
        CHECK(file.values<float>("own") == std::vector<float>{7});
        if (deviation > 0)
            CHECK(load_linear_machine<2>(file).parameters().standardise->deviation[1] == deviation);
        else
            CHECK_THROWS_WITH_AS((void)load_linear_machine<2>(file),
                                 ("file: tensor 'standardise.deviation': expected positive numbers, found " +
                                  std::to_string(deviation))
                                     .c_str(),
                                 file_error);
        CHECK_THROWS_AS(add_machine(writer, linear_machine<>(parts)), std::invalid_argument);
    }
}

TEST_CASE("svm_file: what is not what it should be are refused in words") {
    CHECK(error_of([](auto&, auto&) {}) == "no error");
    const auto has = [](const std::string& error, const char* part) {
        CAPTURE(error);
        CHECK(error.find(part) != std::string::npos);
    };
    has(error_of([](auto& w, auto&) { w.metadata.erase("format"); }),
        "metadata 'format': expected 'tactnet', found none");
    has(error_of([](auto& w, auto&) { w.metadata["version"] = "2"; }),
        "metadata 'version': expected '1', found '2'");
    has(error_of([](auto& w, auto&) { w.metadata["kernel"] = "linear"; }),
        "metadata 'kernel': expected 'rbf', found 'linear'");
    has(error_of([](auto& w, auto&) { w.metadata["multiclass"] = "x"; }),
        "expected 'one versus one' or 'one versus rest', found 'x'");
    has(error_of([](auto&, auto& p) { p.gamma[0] = -1; }),
        "tensor 'gamma': expected a number of 0 or more, found -1");
    has(error_of([](auto&, auto& p) { p.gamma.clear(); }), "a tensor 'gamma'");
    has(error_of([](auto&, auto& p) { p.vectors[1] = std::numeric_limits<float>::quiet_NaN(); }),
        "tensor 'support_vectors'");
    has(error_of([](auto&, auto& p) { p.offsets[0] = std::numeric_limits<double>::infinity(); }),
        "tensor 'offsets'");
    has(error_of([](auto&, auto& p) { p.offsets.push_back(1); }), "offsets: expected 1, found 2");
    has(error_of([](auto&, auto& p) { p.labels[0] = -1; }), "tensor 'labels'");
    has(error_of([](auto&, auto& p) { p.labels = {8, 3}; }), "parts that fit each other");
    has(error_of([](auto&, auto& p) { p.labels.pop_back(); }), "two classes or more");
    has(error_of([](auto&, auto& p) { p.counts = {2, 1}; }), "parts that fit each other");
    has(error_of([](auto&, auto& p) {
            p.vectors.clear();
            p.coefficients.clear();
            p.counts = {0, 0};
        }),
        "support vectors, at least: expected 1, found 0");
    has(error_of([](auto&, auto& p) { p.coefficients.push_back(1); }), "tensor 'coefficients'");
}

TEST_CASE("svm_file: more classes than the file holds the machines of are refused before they take memory") {
    const auto many = [](auto& p) {
        constexpr std::int64_t classes = 200'000; // whose 20 billion machines would take 160 GB
        p.labels.clear();
        for (std::int64_t label = 0; label < classes; ++label)
            p.labels.push_back(label);
        p.counts.assign(p.labels.size(), 0);
    };
    const std::string narrow = error_of([&](auto&, auto& p) { many(p); });
    CAPTURE(narrow);
    CHECK(narrow == "file: tensor 'coefficients': expected 2x199999, found 2x1");
    const std::string without = error_of([&](auto&, auto& p) {
        many(p);
        p.vectors.clear();
        p.coefficients.clear();
    });
    CAPTURE(without);
    CHECK(without.find("tensor 'coefficients': expected 0x199999, found 0x1") != std::string::npos);
}
