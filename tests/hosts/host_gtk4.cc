// SPDX-License-Identifier: MIT
// A host with a GtkGLArea of GTK 4: host_gtk4 SCENE PICTURE.ppm
#include "hosts/edited_draws.hh"

#include "../../examples/write_ppm.hh"

#include <epoxy/gl.h>
#include <gtk/gtk.h>

#include <cstdio>
#include <cstdlib>

namespace {

/** State shared by the callbacks of GTK. */
struct Host {
  gnomon::test::EditedDraws draws;
  const char *picture_path;
  GMainLoop *loop = g_main_loop_new(nullptr, FALSE);
  int status = 1;
  bool is_done = false;
};

[[noreturn]] void fail(const char *why)
{
  std::fprintf(stderr, "host_gtk4: %s\n", why);
  std::exit(1);
}

/** GTK has bound the framebuffer of the widget. */
gboolean render(GtkGLArea *area, GdkGLContext * /*context*/, gpointer user)
try {
  auto &host = *static_cast<Host *>(user);
  if (host.is_done) {
    return TRUE;
  }
  GtkWidget *widget = GTK_WIDGET(area);
  const int scale = gtk_widget_get_scale_factor(widget);
  const glm::ivec2 size_px = scale * glm::ivec2(gtk_widget_get_width(widget), gtk_widget_get_height(widget));
  GLint framebuffer = 0;
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &framebuffer);
  host.is_done = host.draws.draw({.name = GLuint(framebuffer), .size_px = size_px});
  if (host.is_done) {
    std::vector<std::byte> rgba(4 * std::size_t(size_px.x) * std::size_t(size_px.y));
    glBindFramebuffer(GL_READ_FRAMEBUFFER, GLuint(framebuffer));
    glReadPixels(0, 0, size_px.x, size_px.y, GL_RGBA, GL_UNSIGNED_BYTE, rgba.data());
    write_ppm(host.picture_path, size_px.x, size_px.y, rgba);
    host.status = 0;
    g_main_loop_quit(host.loop);
  }
  return TRUE;
}
catch (const std::exception &error) {
  // Exceptions must not pass through GTK.
  fail(error.what());
}

/** Destroy the resources of the device while its context is current. */
void unrealize(GtkGLArea *area, gpointer user)
{
  gtk_gl_area_make_current(area);
  static_cast<Host *>(user)->draws.release();
}

gboolean draw_next(gpointer area)
{
  gtk_gl_area_queue_render(GTK_GL_AREA(area));
  return G_SOURCE_CONTINUE;
}

}  // namespace

int main(int argc, char **argv)
try {
  if (argc != 3 || !gtk_init_check()) {
    std::fprintf(stderr, "usage: host_gtk4 SCENE PICTURE.ppm, with a display\n");
    return 2;
  }
  Host host{gnomon::test::EditedDraws(argv[1]), argv[2]};
  GtkWidget *window = gtk_window_new();
  GtkWidget *area = gtk_gl_area_new();
  gtk_gl_area_set_required_version(GTK_GL_AREA(area), 4, 5);
  gtk_widget_set_size_request(area, 320, 180);
  g_signal_connect(area, "render", G_CALLBACK(render), &host);
  g_signal_connect(area, "unrealize", G_CALLBACK(unrealize), &host);
  gtk_window_set_child(GTK_WINDOW(window), area);
  gtk_window_present(GTK_WINDOW(window));
  if (const GError *error = gtk_gl_area_get_error(GTK_GL_AREA(area))) {
    fail(error->message);
  }
  g_idle_add(draw_next, area);
  g_main_loop_run(host.loop);
  gtk_window_destroy(GTK_WINDOW(window));
  return host.status;
}
catch (const std::exception &error) {
  fail(error.what());
}
