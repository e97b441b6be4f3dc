// SPDX-License-Identifier: MIT
#pragma once

#include <gnomon/gnomon.hh>

#include <functional>

namespace gnomon::test {

/** Makes \a call, and checks something around it. \a name: for messages. */
using CheckCall = std::function<void(const char *name, const std::function<void()> &call)>;

/**
 * Makes the calls of doc/embedding.md in the context that is current, each by \a check, on a copy of \a scene: a device
 * and its renderer, pictures by eevee with and without a time budget, edits, settings, sizes, packets, reports,
 * overlays, unlit, and the end of all of them. \a target: a framebuffer of the host.
 */
void make_host_calls(const scene::Scene &scene, const gpu::HostFramebuffer &framebuffer, const CheckCall &check);

}  // namespace gnomon::test
