//! Groups: of nothing, and what is in none.

use super::{Matter, Review};
use crate::profile::Profile;

impl Review<'_> {
    pub(super) fn groups(&mut self) {
        let (file, profile) = (self.file, self.profile);
        for name in file.groups.keys() {
            let mut members = profile.group(name.as_ref()).into_iter().flatten();
            let is_default = name.as_ref() == Profile::DEFAULT_GROUP;
            let matter = match members.next() {
                None => Matter::EmptyGroup,
                Some(first) if is_default && !first.access.readable() => {
                    if members.any(|point| point.access.readable()) {
                        continue;
                    }
                    Matter::UnreadableDefault
                }
                Some(_) => continue,
            };
            self.tell(&name.span(), format!("groups.{}", name.as_ref()), matter);
        }
        if profile.group(Profile::DEFAULT_GROUP).is_none() {
            let key = format!("groups.{}", Profile::DEFAULT_GROUP);
            self.tell(&file.name.span(), key, Matter::NoDefaultGroup);
        }
        self.ungrouped();
    }

    /// All in one, at the first group: that is where they can be mended.
    fn ungrouped(&mut self) {
        let keys = self.file.groups.keys();
        let Some(first) = keys.map(toml::Spanned::span).min_by_key(|span| span.start) else {
            return;
        };
        let points = &self.profile.points;
        let mut is_grouped = vec![false; points.len()];
        for member in self.profile.groups.iter().flat_map(|group| &group.members) {
            if let Some(grouped) = is_grouped.get_mut(*member) {
                *grouped = true;
            }
        }
        let names: Vec<String> = points
            .iter()
            .zip(is_grouped)
            .filter(|(_, grouped)| !grouped)
            .map(|(point, _)| point.name.clone())
            .collect();
        if !names.is_empty() {
            self.tell(&first, "groups", Matter::Ungrouped { names });
        }
    }
}
