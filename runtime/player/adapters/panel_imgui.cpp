/* panel_imgui.cpp - widgets of the player's panel, and lines drawn over the picture, by Dear ImGui.
 *
 * SPDX-License-Identifier: MIT
 */
#include "adapters/panel_imgui.h"

#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <cstdarg>
#include <cstdio>
#include <exception>
#include <imgui.h>
#include <new>

#include "core/memory.h"

struct parian_panel {
    const parian_env *env;
    ImGuiContext *context;
    bool has_window, has_drawing; // what of the backends was begun
    parian_result result;         // the first failure
};

namespace
{

// Runs a widget in the panel's context. No exception leaves; after one, nothing runs.
template <typename Result, typename Body>
Result guarded(parian_panel *panel, Result otherwise, Body body) noexcept
{
    if (panel->result != PARIAN_OK) {
        return otherwise;
    }
    try {
        ImGui::SetCurrentContext(panel->context);
        return body();
    } catch (const std::bad_alloc &) {
        panel->result = parian_fail(panel->env, PARIAN_E_NOMEM, "no memory for the panel");
    } catch (const std::exception &error) {
        panel->result = parian_fail(panel->env, PARIAN_E_DEVICE, "the panel: %s", error.what());
    } catch (...) {
        panel->result = parian_fail(panel->env, PARIAN_E_DEVICE, "the panel failed");
    }
    return otherwise;
}

template <typename Body> void run(parian_panel *panel, Body body) noexcept
{
    guarded(panel, false, [&] {
        body();
        return true;
    });
}

void choose_style()
{
    ImGui::StyleColorsDark();
    ImGuiStyle &style = ImGui::GetStyle();
    style.WindowRounding = 4;
    style.FrameRounding = 3;
    style.WindowBorderSize = 0;
    style.ItemSpacing = ImVec2(6, 3);
    ImGuiIO &io = ImGui::GetIO();
    io.IniFilename = nullptr; // nothing is remembered on disk
    io.LogFilename = nullptr;
    io.ConfigFlags |= ImGuiConfigFlags_NoMouseCursorChange;
}

} // namespace

parian_result parian_panel_create(const parian_env *env, struct GLFWwindow *window, bool es,
                                  parian_panel **out)
{
    parian_panel *panel = static_cast<parian_panel *>(parian_zalloc(env, 1, sizeof *panel));
    if (!panel) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for the panel");
    }
    panel->env = env;
    run(panel, [&] {
        panel->context = ImGui::CreateContext();
        ImGui::SetCurrentContext(panel->context);
        choose_style();
        panel->has_window = ImGui_ImplGlfw_InitForOpenGL(window, true);
        panel->has_drawing = ImGui_ImplOpenGL3_Init(es ? "#version 300 es" : "#version 330 core");
        if (!panel->has_window || !panel->has_drawing) {
            panel->result = parian_fail(env, PARIAN_E_DEVICE, "Dear ImGui cannot use this OpenGL");
        }
    });
    const parian_result result = panel->result;
    if (result != PARIAN_OK) {
        parian_panel_destroy(panel);
        return result;
    }
    *out = panel;
    return PARIAN_OK;
}

void parian_panel_destroy(parian_panel *panel)
{
    if (!panel) {
        return;
    }
    panel->result = PARIAN_OK;
    run(panel, [&] {
        if (panel->has_drawing) {
            ImGui_ImplOpenGL3_Shutdown();
        }
        if (panel->has_window) {
            ImGui_ImplGlfw_Shutdown();
        }
        ImGui::DestroyContext(panel->context);
    });
    parian_free(panel->env, panel);
}

bool parian_panel_has_mouse(const parian_panel *panel)
{
    ImGui::SetCurrentContext(panel->context);
    return ImGui::GetIO().WantCaptureMouse;
}

bool parian_panel_has_keys(const parian_panel *panel)
{
    ImGui::SetCurrentContext(panel->context);
    return ImGui::GetIO().WantTextInput;
}

void parian_panel_begin(parian_panel *panel)
{
    run(panel, [] {
        ImGui_ImplOpenGL3_NewFrame();
        ImGui_ImplGlfw_NewFrame();
        ImGui::NewFrame();
    });
}

parian_result parian_panel_end(parian_panel *panel)
{
    run(panel, [] {
        ImGui::Render();
        ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
    });
    return panel->result;
}

/* ---- boxes ---- */

bool parian_panel_begin_box(parian_panel *panel, const parian_panel_box *box)
{
    return guarded(panel, false, [&] {
        const ImGuiWindowFlags bare = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoInputs |
                                      ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoNav;
        const float pivot = box->centred ? 0.5f : 0.0f;
        const bool fits = box->width <= 0 || box->height <= 0;
        ImGui::SetNextWindowPos(ImVec2(box->x, box->y),
                                box->bare ? ImGuiCond_Always : ImGuiCond_FirstUseEver,
                                ImVec2(pivot, pivot));
        if (!fits) {
            ImGui::SetNextWindowSize(ImVec2(box->width, box->height), ImGuiCond_FirstUseEver);
        }
        ImGui::SetNextWindowBgAlpha(box->alpha > 0 ? box->alpha : 0.85f);
        return ImGui::Begin(box->title, nullptr,
                            ImGuiWindowFlags_NoSavedSettings | (box->bare ? bare : 0) |
                                (fits ? ImGuiWindowFlags_AlwaysAutoResize : 0));
    });
}

void parian_panel_end_box(parian_panel *panel)
{
    run(panel, [] { ImGui::End(); });
}

bool parian_panel_group(parian_panel *panel, const char *label, bool open_at_first)
{
    return guarded(panel, false, [&] {
        return ImGui::CollapsingHeader(label, open_at_first ? ImGuiTreeNodeFlags_DefaultOpen : 0);
    });
}

void parian_panel_push(parian_panel *panel, int id)
{
    run(panel, [&] { ImGui::PushID(id); });
}

void parian_panel_pop(parian_panel *panel)
{
    run(panel, [] { ImGui::PopID(); });
}

/* ---- widgets ---- */

void parian_panel_text(parian_panel *panel, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    run(panel, [&] { ImGui::TextV(format, arguments); });
    va_end(arguments);
}

void parian_panel_note(parian_panel *panel, const char *text)
{
    run(panel, [&] {
        ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
        ImGui::PushTextWrapPos(0.0f);
        ImGui::TextUnformatted(text);
        ImGui::PopTextWrapPos();
        ImGui::PopStyleColor();
    });
}

void parian_panel_wrapped(parian_panel *panel, const char *text, float width)
{
    run(panel, [&] {
        ImGui::PushTextWrapPos(width);
        ImGui::TextUnformatted(text);
        ImGui::PopTextWrapPos();
    });
}

void parian_panel_same_line(parian_panel *panel)
{
    run(panel, [] { ImGui::SameLine(); });
}

bool parian_panel_button(parian_panel *panel, const char *label)
{
    return guarded(panel, false, [&] { return ImGui::Button(label); });
}

bool parian_panel_check(parian_panel *panel, const char *label, bool *value)
{
    return guarded(panel, false, [&] { return ImGui::Checkbox(label, value); });
}

bool parian_panel_radio(parian_panel *panel, const char *label, bool chosen)
{
    return guarded(panel, false, [&] { return ImGui::RadioButton(label, chosen); });
}

bool parian_panel_slider(parian_panel *panel, const char *label, float *value, float low,
                         float high, const char *format, bool logarithmic)
{
    return guarded(panel, false, [&] {
        return ImGui::SliderFloat(label, value, low, high, format,
                                  logarithmic ? ImGuiSliderFlags_Logarithmic : 0);
    });
}

bool parian_panel_drag3(parian_panel *panel, const char *label, float value[3], float step,
                        const char *format)
{
    return guarded(panel, false,
                   [&] { return ImGui::DragFloat3(label, value, step, 0, 0, format); });
}

bool parian_panel_color(parian_panel *panel, const char *label, float rgb[3])
{
    return guarded(panel, false, [&] {
        return ImGui::ColorEdit3(label, rgb,
                                 ImGuiColorEditFlags_Float | ImGuiColorEditFlags_NoInputs);
    });
}

bool parian_panel_choice(parian_panel *panel, const char *label, const char *const *names,
                         int count, int *chosen)
{
    return guarded(panel, false, [&] {
        return ImGui::Combo(label, chosen, names, count, count < 16 ? count : 16);
    });
}

void parian_panel_graph(parian_panel *panel, const char *label, const float *value, int count,
                        int first, float high, float height)
{
    run(panel, [&] {
        ImGui::PlotLines("", value, count, first, label, 0, high,
                         ImVec2(ImGui::GetContentRegionAvail().x, height));
    });
}

void parian_panel_progress(parian_panel *panel, float fraction, const char *text)
{
    run(panel, [&] { ImGui::ProgressBar(fraction, ImVec2(260, 0), text); });
}

/* ---- over the picture ---- */

void parian_panel_draw_line(parian_panel *panel, const float from[2], const float to[2],
                            uint32_t color, float width)
{
    run(panel, [&] {
        ImGui::GetBackgroundDrawList()->AddLine(ImVec2(from[0], from[1]), ImVec2(to[0], to[1]),
                                                color, width);
    });
}

void parian_panel_draw_circle(parian_panel *panel, const float centre[2], float radius,
                              uint32_t color, float width)
{
    run(panel, [&] {
        ImDrawList *list = ImGui::GetBackgroundDrawList();
        const ImVec2 at(centre[0], centre[1]);
        if (width > 0) {
            list->AddCircle(at, radius, color, 0, width);
        } else {
            list->AddCircleFilled(at, radius, color);
        }
    });
}

void parian_panel_draw_text(parian_panel *panel, const float at[2], uint32_t color,
                            const char *text)
{
    run(panel, [&] { ImGui::GetBackgroundDrawList()->AddText(ImVec2(at[0], at[1]), color, text); });
}
