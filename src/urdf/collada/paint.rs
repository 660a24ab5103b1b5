//! What a COLLADA scene paints a group of faces with: the diffuse colour or texture of its effect.
//!
//! Other channels, shaders and transparency are skipped: exporters disagree on what transparency
//! means, and a robot that is drawn too solid is better than one that is not seen.
//!
//! Source: COLLADA 1.4.1, chapters 5 (`bind_material`) and 7 (`profile_COMMON`).

use super::super::faces::{Image, Paint};
use super::super::xml::Node;
use super::{Scene, numbers};

impl<'d> Scene<'d> {
    /// What `symbol` stands for in an instance of a geometry; nothing where the file does not say.
    pub(super) fn paint(&self, binder: Node<'d>, symbol: Option<&str>) -> Paint {
        self.material(binder, symbol)
            .and_then(|material| self.target(material.child("instance_effect")?, "url"))
            .and_then(|effect| self.effect(effect))
            .unwrap_or_default()
    }

    fn material(&self, binder: Node<'d>, symbol: Option<&str>) -> Option<Node<'d>> {
        let symbol = symbol?;
        let bound = binder
            .child("bind_material")
            .and_then(|bind| bind.child("technique_common"))
            .and_then(|common| {
                common
                    .children_named("instance_material")
                    .find(|instance| instance.value("symbol") == Some(symbol))
            })
            .and_then(|instance| self.target(instance, "target"));
        // Some files bind nothing and give the material's own id.
        bound.or_else(|| self.ids.get(symbol).copied())
    }

    fn effect(&self, effect: Node<'d>) -> Option<Paint> {
        let profile = effect.child("profile_COMMON")?;
        let shader = profile
            .child("technique")?
            .children()
            .find(|shader| shader.child("diffuse").is_some())?;
        let diffuse = shader.child("diffuse")?;
        if let Some(texture) = diffuse.child("texture") {
            let name = texture.value("texture")?;
            return Some(Paint {
                color: None,
                image: self.image(effect, name).map(Image::Named),
                tint: None,
            });
        }
        let color = numbers(diffuse.child("color")?).ok()?;
        Some(Paint {
            color: color
                .first_chunk::<3>()
                .map(|rgb| rgb.map(|x| x.clamp(0.0, 1.0))),
            image: None,
            tint: None,
        })
    }

    /// The file that a sampler shows: sampler → surface → image in 1.4, sampler → image in 1.5;
    /// some files name the image at once.
    fn image(&self, effect: Node<'d>, name: &str) -> Option<String> {
        let parameter = |sid: &str| {
            effect
                .descendants()
                .find(|node| node.local_name() == "newparam" && node.value("sid") == Some(sid))
        };
        let text = |node: Node| node.content().trim().to_owned();
        let mut id = name.to_owned();
        if let Some(sampler) = parameter(name).and_then(|p| p.child("sampler2D")) {
            if let Some(instance) = sampler.child("instance_image") {
                instance
                    .value("url")?
                    .trim_start_matches('#')
                    .clone_into(&mut id);
            } else {
                let surface = parameter(&text(sampler.child("source")?))?.child("surface")?;
                id = text(surface.child("init_from")?);
            }
        }
        let from = self.ids.get(id.as_str())?.child("init_from")?;
        let name = from.child("ref").map_or_else(|| text(from), text);
        (!name.is_empty()).then_some(name)
    }
}
