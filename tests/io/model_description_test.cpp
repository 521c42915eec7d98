#include <tactnet/io/model_description.hpp>
#include <tactnet/io/safetensors/writer.hpp>

#include <doctest/doctest.h>

#include <string>
#include <vector>

using namespace tactnet;

namespace {

safetensors file_of(const file_metadata& metadata) {
    safetensors_writer writer;
    writer.metadata = metadata;
    return safetensors::parse(writer.to_bytes(), "m.safetensors");
}

file_metadata example() {
    file_metadata metadata{{"network", "small"}, {"seed", "7"}};
    add_description(metadata, {.network = "not written",
                               .rows = 4,
                               .columns = 6,
                               .classes = {"cable", "a \"quoted\", one", "Schlüssel\n"},
                               .epsilon = 0.1,
                               .subtracts_mean = true,
                               .scale = 1.0F / 255});
    return metadata;
}

} // namespace

TEST_CASE("model_description: what was added is read back, number for number") {
    const model_description d = describe_model(file_of(example()));
    CHECK(d.network == "small");
    CHECK(d.rows == 4);
    CHECK(d.columns == 6);
    CHECK(d.classes == std::vector<std::string>{"cable", "a \"quoted\", one", "Schlüssel\n"});
    CHECK(d.epsilon == 0.1);
    CHECK(d.subtracts_mean == true);
    CHECK(d.scale == 1.0F / 255);
}

TEST_CASE("model_description: a file that says nothing") {
    const model_description d = describe_model(file_of({}));
    CHECK(d.network.empty());
    CHECK_FALSE(d.rows);
    CHECK_FALSE(d.columns);
    CHECK(d.classes.empty());
    CHECK_FALSE(d.epsilon);
    CHECK_FALSE(d.subtracts_mean);
    CHECK_FALSE(d.scale);
}

TEST_CASE("model_description: numbers: our own must mean something, those of others may mean anything") {
    for (const char* key : {"rows", "columns", "epsilon", "input_scale"})
        for (const char* wrong : {"", "0", "-1", "nan", "inf", "4 ", "four"}) {
            file_metadata metadata = example();
            metadata[key] = wrong;
            CAPTURE(key);
            CAPTURE(wrong);
            CHECK_THROWS_AS(static_cast<void>(describe_model(file_of(metadata))), file_error);
            metadata["format"] = "pt";
            CHECK_NOTHROW(static_cast<void>(describe_model(file_of(metadata))));
        }
}
