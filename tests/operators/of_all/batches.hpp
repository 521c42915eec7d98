// A slice of the list: what must hold of every layer, in batches, and the costs of the network that it is.

#include <operators/list.hpp>
#include <support/layers/conformance.hpp>

using namespace tactnet;

TEST_CASE_TEMPLATE_DEFINE("operators: what must hold of every layer", Example, batches_of_all) {
    support::check_layer<typename Example::spec, Example::input>(Example::how::options);
    using net = typename Example::alone;
    const support::reference_pointer reference = support::reference_of<typename Example::spec>::on(
        {Example::input.channels, Example::input.rows, Example::input.columns});
    CHECK(net::parameters == reference->parameters);
    CHECK(net::multiply_adds == reference->multiply_adds);
    CHECK(net::multiply_adds_on_pixels == reference->multiply_adds_on_pixels);
    CHECK(net::outputs == reference->output.size());
}
TEST_CASE_TEMPLATE_APPLY(batches_of_all,
                         support::examples_of_slice<support::any_example, TACTNET_SLICE, TACTNET_SLICES>);
