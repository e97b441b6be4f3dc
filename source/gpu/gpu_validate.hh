// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_command_list.hh"

namespace gnomon::gpu {

/**
 * Checks \a list against the resources and limits of \a device, before a backend sees it. Device::submit calls this in
 * builds with assertions (without NDEBUG), for every backend.
 *
 * Checked are: the nesting of passes; draws and updates where they are not allowed; ids of destroyed resources; the
 * kind, size, alignment and range of bound buffers; bindings and push constants that the current shader declares and
 * the list does not supply; textures that are sampled while they are attached to the framebuffer; draws that read
 * beyond the list's arrays or outside of the vertex and index data of live batches.
 *
 * Bindings stay in effect until they are replaced or the list ends. State is reset at the begin of each pass.
 *
 * \throws Error naming the pass, the command, the resource and the reason, for the first violation.
 */
void validate(const CommandList &list, const Device &device);

}  // namespace gnomon::gpu
