//! The model of the machine for an agent of MTConnect (`Devices.xml`), from the table of data items.
//! Source: ANSI/MTC1.4 part 2; schema MTConnectDevices 2.2.

use std::fmt::Write;

use crate::defs::param;
use crate::link::condition::Condition;
use crate::link::data_item::{Category, Component, DataItem, data_items};
use crate::link::snapshot::Snapshot;
use crate::units::Axis;

/// Namespace of the version of the standard.
const NAMESPACE: &str = "urn:mtconnect.org:MTConnectDevices:2.2";

/// Unique name of a machine, by its kind and its number (P482): `kt830-gc-000123`.
#[must_use]
pub fn device_uuid(snapshot: &Snapshot) -> String {
    format!("kt830-{}-{:06}", snapshot.kind.id(), snapshot.params.get(param::MACHINE_NUMBER))
}

/// The document. `created` is the time in UTC by ISO 8601.
#[must_use]
pub fn device_model(snapshot: &Snapshot, created: &str) -> String {
    let number = snapshot.params.get(param::MACHINE_NUMBER);
    let prefix = format!("{}{number:06}_", snapshot.kind.id());
    let conditions = Condition::of_machine(snapshot).collect();
    let model = DeviceModel { items: data_items(snapshot).collect(), conditions, prefix };
    let uuid = device_uuid(snapshot);
    let fitted = |components: &[Component]| -> String {
        let fitted = components.iter().filter(|component| component.is_fitted(snapshot));
        fitted.map(|component| model.component(*component, "")).collect()
    };
    let axes = fitted(&Axis::ALL.map(Component::Axis));
    let systems = fitted(&[Component::Coolant, Component::Hydraulic, Component::Lubrication]);
    let children = [
        model.component(Component::Axes, &format!("{axes}{}", model.component(Component::Spindle, ""))),
        model.component(Component::Controller, &model.component(Component::Path, "")),
        fitted(&[Component::Door]),
        fitted(&[Component::Gauge]),
        format!(
            "<Parts id=\"{}parts\"><Components>{}</Components></Parts>",
            model.prefix,
            model.component(Component::LastPart, "")
        ),
        format!("<Systems id=\"{}systems\"><Components>{systems}</Components></Systems>", model.prefix),
    ];
    let description = format!("KT-830 {}", snapshot.kind.name().en);
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
         <MTConnectDevices xmlns=\"{NAMESPACE}\">\n\
         <Header creationTime=\"{created}\" sender=\"kt830\" instanceId=\"1\" version=\"2.2\" \
         deviceModelChangeTime=\"{created}\" assetBufferSize=\"1\" assetCount=\"0\" bufferSize=\"1\"/>\n\
         <Devices><Device id=\"{}device\" name=\"{uuid}\" uuid=\"{uuid}\">\n\
         <Description manufacturer=\"KT-830\">{description}</Description>\n{}<Components>{}</Components>\n\
         </Device></Devices>\n</MTConnectDevices>\n",
        model.prefix,
        model.items(Component::Device),
        children.concat(),
    )
}

/// The items of a machine.
struct DeviceModel {
    items: Vec<DataItem>,
    conditions: Vec<Condition>,
    /// Begin of every id: an agent may have several machines. The names are those that the lines have.
    prefix: String,
}

impl DeviceModel {
    /// A component with its items and the components in it.
    fn component(&self, component: Component, children: &str) -> String {
        let (element, id) = element(component);
        let name = match component {
            Component::Axis(axis) => format!(" name=\"{axis}\""),
            Component::Spindle => " name=\"S\"".to_owned(),
            _ => String::new(),
        };
        let inner = if children.is_empty() { String::new() } else { format!("<Components>{children}</Components>") };
        let prefix = &self.prefix;
        format!("<{element} id=\"{prefix}{id}\"{name}>{}{inner}</{element}>\n", self.items(component))
    }

    /// The items and conditions of a component.
    fn items(&self, component: Component) -> String {
        let mut text = String::new();
        for item in self.items.iter().filter(|item| item.component == component) {
            text += &self.data_item(item);
        }
        for (id, _, kind) in self.conditions.iter().map(|condition| condition.row()).filter(|row| row.1 == component) {
            // Writing to a string does not fail.
            let _ = write!(
                text,
                "<DataItem category=\"CONDITION\" id=\"{}{id}\" name=\"{id}\" type=\"{kind}\"/>",
                self.prefix
            );
        }
        if text.is_empty() { text } else { format!("<DataItems>{text}</DataItems>") }
    }

    fn data_item(&self, item: &DataItem) -> String {
        let (category, units) = match item.category {
            Category::Sample(units) => ("SAMPLE", units),
            Category::EventWithUnits(units) => ("EVENT", units),
            Category::Event => ("EVENT", ""),
        };
        let attributes = [
            ("category", category),
            ("type", item.kind),
            ("subType", item.sub_type),
            ("units", units),
            ("coordinateSystem", item.coordinate_system()),
        ];
        let written = attributes.into_iter().filter(|(_, value)| !value.is_empty());
        let words: String = written.map(|(name, value)| format!(" {name}=\"{value}\"")).collect();
        let (prefix, name) = (&self.prefix, item.id());
        format!("<DataItem id=\"{prefix}{name}\" name=\"{name}\"{words}/>")
    }
}

/// Element and id of a component.
fn element(component: Component) -> (&'static str, String) {
    let (element, id) = match component {
        Component::Axis(axis) => return ("Linear", format!("axis_{axis}").to_ascii_lowercase()),
        Component::Device => ("Device", "device"),
        Component::Controller => ("Controller", "controller"),
        Component::Path => ("Path", "path"),
        Component::Axes => ("Axes", "axes"),
        Component::Spindle => ("Rotary", "spindle"),
        Component::Coolant => ("Coolant", "coolant_system"),
        Component::Hydraulic => ("Hydraulic", "hydraulic_system"),
        Component::Lubrication => ("Lubrication", "lubrication_system"),
        Component::Gauge => ("Sensor", "gauge"),
        Component::LastPart => ("PartOccurrence", "last_part"),
        Component::Door => ("Door", "door"),
    };
    (element, id.to_owned())
}
