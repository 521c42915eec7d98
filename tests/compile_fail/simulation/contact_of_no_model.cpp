// expect: contact: its model must be a struct of parameters with a class template bound<shape>
#include <tactnet/simulation.hpp>

using namespace tactnet::simulation;
struct spring {
    double stiffness = 1;
};
scene<array<8, 12>, contact<spring>> touched;
