// `using namespace tactnet`, as the pages write it, must not get in the way of a program's own names.
// Compiling is the test: a name that the library also has at the top of its namespace would be ambiguous
// where it is used.

#include <cstddef>
#include <every_header.hpp>

using namespace tactnet;

namespace {

int next = 0;

} // namespace

#define TACTNET_OWN_FUNCTION(name)                                                                           \
    static int name(int argument) {                                                                          \
        return argument + ++next;                                                                            \
    }
#define TACTNET_OWN_TYPE(name)                                                                               \
    struct name {                                                                                            \
        int value = ++next;                                                                                  \
    };

// Lists that clang-format would move at each run.
// clang-format off
#define TACTNET_ORDINARY_VERBS(X)                                                                            \
    X(clear)                                                                                                 \
    X(compute)                                                                                               \
    X(draw)                                                                                                  \
    X(fill)                                                                                                  \
    X(find)                                                                                                  \
    X(init) X(load) X(log) X(pass) X(print) X(process) X(read) X(run) X(same) X(save) X(show) X(start)       \
        X(stop) X(update) X(valid) X(write)
#define TACTNET_ORDINARY_NOUNS(X)                                                                            \
    X(action)                                                                                                \
    X(box)                                                                                                   \
    X(buffer)                                                                                                \
    X(camera)                                                                                                \
    X(circle)                                                                                                \
    X(config) X(context) X(counter) X(data) X(device) X(entry) X(event) X(extent) X(field) X(filter)         \
        X(finger) X(force) X(frame) X(grasp) X(gripper) X(group) X(hand) X(identity) X(image) X(item) X(job) \
            X(kernel) X(label) X(line) X(list) X(mode) X(node) X(noise) X(object) X(options) X(order)        \
                X(page) X(pixel) X(point) X(position) X(range) X(rate) X(region) X(result) X(robot) X(role)  \
                    X(row) X(rule) X(sample) X(score) X(section) X(seen) X(sensor) X(settings) X(share)      \
                        X(side) X(size) X(span) X(stage) X(state) X(status) X(step) X(summary) X(table)      \
                            X(task) X(team) X(timer) X(touch) X(user) X(value) X(window) X(worker)
// clang-format on

TACTNET_ORDINARY_VERBS(TACTNET_OWN_FUNCTION)
TACTNET_ORDINARY_NOUNS(TACTNET_OWN_TYPE)

int sum_of_own_names();
int sum_of_own_names() {
    int sum = 0;
#define TACTNET_USE_FUNCTION(name) sum += name(1);
#define TACTNET_USE_TYPE(name) sum += name{}.value;
    TACTNET_ORDINARY_VERBS(TACTNET_USE_FUNCTION)
    TACTNET_ORDINARY_NOUNS(TACTNET_USE_TYPE)
    return sum;
}

// Names of the library that describe what they are.
using own_network = network<::tactnet::shape{28, 50, 1}, conv2d<8, extent2d{5, 3}, 1, padding::valid>,
                            residual<conv2d<8, 3>, identity_layer>, dense<22>, softmax>;
static_assert(own_network::outputs == 22);
