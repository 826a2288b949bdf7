#include "src/mesh/gmsh_session.hpp"

#include <gmsh.h>

#include <exception>

namespace quern {
namespace {

std::mutex& gmsh_mutex() {
    static std::mutex mutex;
    return mutex;
}

/// gmsh 4.8 has no isInitialized(); reading an option fails, or leaves the value alone, before initialize().
bool is_initialised() {
    double value = -1.0;
    try {
        gmsh::option::getNumber("General.Terminal", value);
    } catch (...) {
        return false;
    }
    return value >= 0.0;
}

/// Initialises gmsh unless someone has, and finalises it at the end of the process if it was this one.
struct Library {
    bool ours = false;
    Library() {
        if (is_initialised()) return;
        gmsh::initialize(0, nullptr, false);
        gmsh::option::setNumber("General.Terminal", 0);
        ours = true;
    }
    ~Library() {
        try {
            if (ours && is_initialised()) gmsh::finalize();
        } catch (...) {  // nothing can be done about it at exit
        }
    }
};

void ensure_library() {
    static Library library;
    // The caller's program may have finalised gmsh between two sessions.
    if (!is_initialised()) {
        gmsh::initialize(0, nullptr, false);
        gmsh::option::setNumber("General.Terminal", 0);
        library.ours = true;
    }
}

}  // namespace

GmshSession::GmshSession() : lock_(gmsh_mutex()) {
    ensure_library();
    set("General.Terminal", 0);
    set("General.AbortOnError", 2);
    set("General.NumThreads", 1);
    gmsh::model::getCurrent(previous_model_);
    gmsh::model::add("quern");
}

GmshSession::~GmshSession() {
    try {
        gmsh::model::remove();
        gmsh::model::setCurrent(previous_model_);
        for (auto option = previous_options_.rbegin(); option != previous_options_.rend(); ++option)
            gmsh::option::setNumber(option->first, option->second);
    } catch (...) {  // a destructor must not throw; the next session starts from its own settings
    }
}

void GmshSession::set(const std::string& option, double value) {
    double previous = 0.0;
    gmsh::option::getNumber(option, previous);
    previous_options_.emplace_back(option, previous);
    gmsh::option::setNumber(option, value);
}

std::string current_gmsh_error() {
    try {
        throw;
    } catch (const std::exception& error) {
        return error.what();
    } catch (const std::string& error) {
        return error;
    } catch (const char* error) {
        return error;
    } catch (int code) {
        return "error " + std::to_string(code);
    } catch (...) {
        return "unknown error";
    }
}

}  // namespace quern
