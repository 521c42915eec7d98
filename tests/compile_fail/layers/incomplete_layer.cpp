// expect: sequence: expected a layer; the concept layer shows what is missing
// expect: backward
// at-most: 1
// characters: 16000
#include <tactnet/networks.hpp>

struct forward_only {
    static constexpr std::string_view name = "forward_only";
    static constexpr bool numbered = true;
    static constexpr tactnet::layer_costs costs(const tactnet::shape& input) { return {.output = input}; }

    template <class T, tactnet::shape Input>
    struct layer : tactnet::layer_base<T, Input, forward_only> {
        static void infer(const tactnet::execution_context&, const T*, const T*, tactnet::no_memory&,
                          tactnet::input_view<T, Input>, tactnet::output_view<T, Input>) {}
    };
};
using net = tactnet::network<tactnet::shape{28, 50}, tactnet::conv2d<8, 5>, forward_only, tactnet::dense<22>>;
void prepare(const net& network, tactnet::thread_pool& threads, net::workspace& space) {
    network.prepare(threads, space);
}
