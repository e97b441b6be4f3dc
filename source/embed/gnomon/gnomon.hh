// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_scene_renderer.hh"
#include "gltf_import.hh"
#include "gpu_device.hh"
#include "scene.hh"
#include "unlit_engine.hh"

/**
 * All that a host needs to show a lit scene in its own window. doc/embedding.md explains it; examples/ has programs.
 *
 *     auto device = gnomon::gpu::create_gl_device({.context = gnomon::gpu::ContextKind::Host});
 *     gnomon::scene::Scene scene = gnomon::gltf::import_gltf("scene.glb");
 *     gnomon::eevee::SceneRenderer renderer(*device, scene, size_px, {.sample_count = 64});
 *     // Each frame, after edits of the scene:
 *     renderer.sync();
 *     renderer.draw_sample(camera, {.framebuffer = gnomon::gpu::HostFramebuffer{.size_px = size_px}});
 *
 * Lifetimes: the device and the scene outlive the renderer. All are used on the thread of the host's context, which is
 * current in every call, and left as it was.
 */
