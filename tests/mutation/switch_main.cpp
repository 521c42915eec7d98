// Switches one mutant on, MUTANT=number, and lists those that a run reached in the file MUTANTS_REACHED.

#include <cstdio>
#include <cstdlib>

extern "C" {
int mutant_switched_on = 0;
bool mutants_reached[100000];
}

__attribute__((constructor(101))) static void begin() {
    if (const char* const number = std::getenv("MUTANT"))
        mutant_switched_on = std::atoi(number);
}

__attribute__((destructor(101))) static void end() {
    const char* const name = std::getenv("MUTANTS_REACHED");
    if (std::FILE* const file = name ? std::fopen(name, "w") : nullptr) {
        for (int n = 0; n < 100000; ++n)
            if (mutants_reached[n])
                std::fprintf(file, "%d\n", n);
        std::fclose(file);
    }
}
