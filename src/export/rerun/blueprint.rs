//! The layout that a recording opens in: frames over the table at the left, who says what over time at the right.

use ::rerun::blueprint::components::{PanelState, PlayState};
use ::rerun::blueprint::{
    Blueprint, BlueprintActivation, BlueprintPanel, ContainerLike, Horizontal, SelectionPanel,
    Spatial2DView, Spatial3DView, Tabs, TextDocumentView, TimePanel, TimeSeriesView, Vertical,
};

use super::log::STEP;
use super::{Shown, about, each, recorded, space};
use crate::export::Run;
use crate::export::step::readings_of;

/// A default layout loses a race with the viewer's own; an active one does not.
pub(super) const ACTIVE: BlueprintActivation = BlueprintActivation {
    make_active: true,
    make_default: false,
};

/// Where the viewer's cursor is.
#[derive(Clone, Copy)]
pub(super) enum Playing {
    /// At the first step, for a file.
    Paused,
    /// At the newest one, for a stream.
    Following,
}

pub(super) fn layout(run: &Run, playing: Playing) -> Blueprint {
    let play = match playing {
        Playing::Paused => PlayState::Paused,
        Playing::Following => PlayState::Following,
    };
    let models: Vec<Shown<'_>> = each(run).collect();
    let left = Vertical::new([frames(&models), table()])
        .with_row_shares(vec![models.len().max(1) as f32, 2.0]);
    let root = Horizontal::new([left.into(), series(&models)]).with_column_shares(vec![1.0, 1.0]);
    Blueprint::new(root)
        .with_auto_views(false)
        .with_auto_layout(false)
        .with_time_panel(
            TimePanel::new()
                .with_timeline(STEP)
                .with_play_state(play)
                .with_state(PanelState::Collapsed),
        )
        .with_blueprint_panel(BlueprintPanel::from_state(PanelState::Collapsed))
        .with_selection_panel(SelectionPanel::from_state(PanelState::Collapsed))
}

fn frames(models: &[Shown<'_>]) -> ContainerLike {
    let picture = |name: String, entity: String| -> ContainerLike {
        Spatial2DView::new(name)
            .with_origin(format!("/{entity}"))
            .into()
    };
    let rows = models.iter().map(|model| {
        let said = |what: &str| picture(model.says(what), format!("{}/frames/{what}", model.name));
        let truth = picture("truth".to_owned(), recorded::FRAME.to_owned());
        Horizontal::new([truth, said("belief"), said("prediction"), said("error")]).into()
    });
    Vertical::new(rows.collect::<Vec<ContainerLike>>()).into()
}

fn table() -> ContainerLike {
    Spatial3DView::new("table")
        .with_origin(format!("/{}", space::ROOT))
        .into()
}

fn series(models: &[Shown<'_>]) -> ContainerLike {
    let plot = |name: &str, entities: Vec<String>| -> ContainerLike {
        let contents: Vec<String> = entities
            .iter()
            .map(|entity| format!("+ /{entity}"))
            .collect();
        TimeSeriesView::new(name)
            .with_origin("/")
            .with_contents(contents)
            .into()
    };
    let of_experts = |reading: &str| -> Vec<String> {
        let experts = models.iter().flat_map(|model| {
            let all = model.first().experts.iter().map(|view| view.expert);
            all.map(move |expert| (model, expert))
        });
        experts
            .filter(|(_, expert)| readings_of(*expert).any(|has| has.name == reading))
            .map(|(model, expert)| format!("{}/{reading}", model.of_expert(expert)))
            .collect()
    };
    let of_models = |what: &str| -> Vec<String> {
        let each = models.iter();
        each.map(|model| format!("{}/{what}", model.name)).collect()
    };
    let readings = |names: &[&str]| -> Vec<String> {
        let each = names.iter();
        each.flat_map(|name| of_models(&format!("readings/{name}")))
            .collect()
    };
    let overview: Vec<ContainerLike> = vec![
        plot(
            "share of the belief's precision (D1)",
            of_experts("share_mean"),
        ),
        plot(
            "distance from the recorded position, m",
            readings(&["belief_error_m", "prediction_error_m"]),
        ),
        plot(
            "PSNR, dB",
            readings(&["psnr_belief_db", "psnr_prediction_db"]),
        ),
        plot("force over the step, N", readings(&["force_n"])),
    ];
    let consistency: Vec<ContainerLike> = vec![
        plot("NIS against A P Aᵀ + Q (D8)", of_experts("nis_propagated")),
        plot(
            "KL(belief ‖ expert), part of the means, nats (D3)",
            of_experts("overruled_mean_nats"),
        ),
        plot(
            "surprise, conflict (D2, D10)",
            readings(&["surprise_nats", "conflict"]),
        ),
        plot(
            "NEES of the position (D11)",
            readings(&["nees", "nees_without_rp"]),
        ),
    ];
    let latent: Vec<ContainerLike> = vec![
        plot("belief, mean", of_models("belief/mean")),
        plot("belief, sigma", of_models("belief/sigma")),
    ];
    let sensed: Vec<ContainerLike> = vec![
        plot("force, N", vec![recorded::FORCE.to_owned()]),
        plot("torque, N·m", vec![recorded::TORQUE.to_owned()]),
        plot("tip, m", vec![recorded::POSITION.to_owned()]),
        plot("tip, m/s", vec![recorded::VELOCITY.to_owned()]),
        plot("control", vec![recorded::CONTROL.to_owned()]),
    ];
    let tab = |name: &str, views: Vec<ContainerLike>| -> ContainerLike {
        Vertical::new(views).with_name(name).into()
    };
    let about: ContainerLike = TextDocumentView::new("about")
        .with_origin(format!("/{}", about::ABOUT))
        .into();
    Tabs::new([
        tab("fusion", overview),
        tab("consistency", consistency),
        tab("latent", latent),
        tab("sensors", sensed),
        about,
    ])
    .into()
}
