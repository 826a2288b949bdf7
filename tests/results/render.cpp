#include <doctest/doctest.h>
#include "src/results/render.hpp"
#include <cstdlib>
#include <chrono>
#include <cstdio>
TEST_CASE("try") {
    for (const char* f : {"speed","stress_xx","grain","damage","displacement"}) for (const char* dir : {"/tmp/r2","/tmp/r3"}) {
        auto t0=std::chrono::steady_clock::now();
        quern::RenderOptions o; o.directory=dir; o.field=f; o.file=std::string("/tmp/pic/")+f+(dir[6]=='2'?"2.png":"3.png");
        quern::render(o);
        printf("%s %.2f\n", o.file.c_str(), std::chrono::duration<double>(std::chrono::steady_clock::now()-t0).count());
    }
}
